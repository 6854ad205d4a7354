// One variable against another, over the range of time that the plots show.

const PHASE_PAD = { left: 78, right: 26, top: 8, bottom: 24 };
const PHASE_APART = [80, 36];  // pixels between ticks, at least
const PHASE_HEIGHT = 230, PHASE_POINTS = 3000;

// What can be drawn against each other: the variables of time plots, each with its series.
function variablesOf(plots) {
  const found = new Map();
  for (const one of plots.flatMap((plot) => plot.series)) {
    if (!one.variable) continue;
    if (!found.has(one.variable)) found.set(one.variable, { name: one.name, unit: one.unit, series: [] });
    const { series } = found.get(one.variable);
    if (!series.some(({ actor }) => actor === one.actor)) series.push(one);
  }
  return found;
}

// A coordinate and its rate: an angle where there is one, else a length; null where there is none.
function usualPair(variables) {
  for (const unit of ["rad", "m"]) {
    const of = (wanted) => [...variables].find(([, one]) => one.unit === wanted)?.[0];
    if (of(unit) && of(`${unit}/s`)) return [of(unit), of(`${unit}/s`)];
  }
  return null;
}

class PhasePlot {
  // variables: as variablesOf gives them; chosen: two of their names, changed in place; page: as of TimePlot.
  constructor(variables, chosen, page) {
    this.spec = { title: "Phase plot", shown: true };
    this.variables = variables;
    this.chosen = chosen;
    this.page = page;
    this.whole = false;
    this.build();
    this.choose();
  }

  build() {
    const head = element("header"), title = element("h3", this.spec.title);
    const select = (k, words) => {
      const made = element("select", undefined, { "aria-label": words, class: "small" });
      for (const [variable, { name }] of this.variables) made.append(element("option", name, { value: variable }));
      made.value = this.chosen[k];
      made.addEventListener("change", () => {
        this.chosen[k] = made.value;
        this.choose();
        this.mount();
      });
      return made;
    };
    const picture = element("button", "PNG", { type: "button", class: "small", title: "Save as PNG", "aria-label": "Save as PNG: Phase plot" });
    picture.addEventListener("click", () => (
      download(plotPicture(this, this.page.colours()), fileName(this.page.name, this.heading()))));
    this.all = element("button", "all", {
      type: "button", class: "small", "aria-pressed": "false", title: "All of a run that leaves the others behind",
    });
    this.all.addEventListener("click", () => {
      this.whole = !this.whole;
      this.all.setAttribute("aria-pressed", String(this.whole));
      this.mount();
    });
    head.append(title, this.all, picture);
    const axes = element("div", undefined, { class: "axes" });
    axes.append(select(1, "Phase plot: upwards"), element("span", "against"), select(0, "Phase plot: to the right"));
    this.legend = element("ul", undefined, { class: "legend" });
    this.box = element("div", undefined, { class: "chart phase", "aria-hidden": "true" });
    const canvas = element("canvas");
    this.box.append(canvas);
    this.chart = { ctx: canvas.getContext("2d"), width: 0, height: PHASE_HEIGHT, destroy() {} };
    canvas.addEventListener("pointerdown", (event) => this.seek(event.offsetX, event.offsetY));
    this.element = element("section", undefined, { class: "plot" });
    this.element.append(head, axes, this.box, this.legend);
  }

  // The lines of the two variables: of each body its own.
  choose() {
    const [x, y] = this.chosen.map((name) => this.variables.get(name));
    this.units = [x.unit, y.unit];
    this.lines = y.series.flatMap((up) => {
      const right = x.series.find((one) => one.actor === up.actor && one.times === up.times);
      return right ? [{ x: right, y: up, actor: up.actor, text: up.owner || up.name, dash: [], colour: () => this.page.colours().actors[up.actor % 8] }] : [];
    });
    // Copies, so that a hidden time plot does not take its series along.
    for (const line of this.lines) Object.assign(line, { x: { ...line.x }, y: { ...line.y } });
    this.series = this.lines.flatMap((line) => [line.x, line.y]);
    this.judge();
    this.element.setAttribute("aria-label", this.heading());
    for (const { marker } of this.marked ?? []) marker.remove();
    this.legend.replaceChildren();
    this.marked = this.lines.map((line) => {
      const marker = element("i", undefined, { class: "marker" }), item = element("li"), value = element("output");
      item.append(element("i", undefined, { "aria-hidden": "true", class: `dot c${line.actor % 8}` }));
      if (this.lines.length > 1) item.append(element("span", line.text));
      item.append(value);
      this.legend.append(item);
      this.box.append(marker);
      return { line, marker, value };
    });
  }

  // Whether a run leaves the others behind.
  judge() {
    this.bounds = [0, 1].map((axis) => boundsOf(this.lines.map((line) => (
      { ...[line.x, line.y][axis], label: "" }))));
    this.all.hidden = !this.bounds.some(Boolean);
  }

  heading() {
    const [x, y] = this.chosen.map((name) => this.variables.get(name).name);
    return `Phase plot: ${y} against ${x}`;
  }

  shows(line) {
    return !this.page.hides(line.actor);
  }

  turned(axis) {
    return this.page.degrees() && degreesOf(this.units[axis]) ? DEGREE : 1;
  }

  mount() {
    const { ctx } = this.chart, ratio = Math.min(devicePixelRatio || 1, 3);
    this.chart.width = Math.max(this.box.clientWidth, 160);
    ctx.canvas.width = Math.round(this.chart.width * ratio);
    ctx.canvas.height = Math.round(PHASE_HEIGHT * ratio);
    this.ratio = ratio;
    this.refresh();
  }

  // The part of a line that lies in the range of time: from one sample to another, and how many to leave out.
  part({ x: { times } }) {
    const [from, to] = this.page.range(), first = indexAt(times, from), last = indexAt(times, to);
    return [first, last, Math.max(1, Math.ceil((last - first) / PHASE_POINTS))];
  }

  // Ends of an axis: of what is shown, without what leaves all behind, at whole ticks.
  ends(axis, pixels) {
    let low = Infinity, high = -Infinity;
    for (const line of this.lines.filter((one) => this.shows(one))) {
      const { values } = [line.x, line.y][axis], [first, last, stride] = this.part(line);
      for (let k = first; k <= last; k += stride) {
        if (values[k] < low) low = values[k];
        if (values[k] > high) high = values[k];
      }
    }
    const bounds = this.whole ? null : this.bounds[axis], turn = this.turned(axis);
    if (bounds && low <= bounds[1] && high >= bounds[0]) [low, high] = [Math.max(low, bounds[0]), Math.min(high, bounds[1])];
    [low, high] = low <= high ? linearRange(low * turn, high * turn) : [0, 1];
    const step = ruleOf({ scale: pixels / (high - low) }, PHASE_APART[axis]);
    return { low: step / 2 * Math.floor(low / step * 2), high: step / 2 * Math.ceil(high / step * 2), step };
  }

  refresh() {
    const { ctx: c, width } = this.chart;
    if (!width || !this.lines.length) return;
    const colours = this.page.colours(), { left, right, top, bottom } = PHASE_PAD;
    const w = width - left - right, h = PHASE_HEIGHT - top - bottom;
    const [x, y] = [this.ends(0, w), this.ends(1, h)];
    this.place = [(value) => left + (value * this.turned(0) - x.low) / (x.high - x.low) * w,
      (value) => top + (y.high - value * this.turned(1)) / (y.high - y.low) * h];
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.clearRect(0, 0, width, PHASE_HEIGHT);
    this.ticks(c, x, y, w, h, colours);
    c.save();
    c.beginPath();
    c.rect(left, top, w, h);
    c.clip();
    for (const line of this.lines) if (this.shows(line)) this.path(c, line);
    c.restore();
    if (this.time !== undefined) this.at(this.time);
  }

  ticks(c, x, y, w, h, colours) {
    const { left, top } = PHASE_PAD, units = this.units.map((unit, axis) => prettyUnit(this.turned(axis) === 1 ? unit : degreesOf(unit)));
    c.font = colours.font;
    c.lineWidth = 1;
    c.strokeStyle = colours.grid;
    c.fillStyle = colours.muted;
    c.beginPath();
    const each = ({ low, high, step }, draw) => {
      for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) draw(k * step, tickText(Number((k * step).toPrecision(12))));
    };
    c.textAlign = "center";
    each(x, (value, text) => {
      const at = Math.round(left + (value - x.low) / (x.high - x.low) * w) + 0.5;
      c.moveTo(at, top);
      c.lineTo(at, top + h);
      c.fillText(`${text} ${units[0]}`.trim(), at, top + h + 17);
    });
    c.textAlign = "right";
    each(y, (value, text) => {
      const at = Math.round(top + (y.high - value) / (y.high - y.low) * h) + 0.5;
      c.moveTo(left, at);
      c.lineTo(left + w, at);
      c.fillText(`${text} ${units[1]}`.trim(), left - 6, at + 4);
    });
    c.stroke();
  }

  path(c, line) {
    const [first, last, stride] = this.part(line), [px, py] = this.place;
    c.strokeStyle = line.colour();
    // One pixel wide, since more takes ten times as long; the first shows under what lies on it.
    c.lineWidth = this.lines.length > 1 && line === this.lines[0] ? 3 : 1 / this.ratio;
    c.beginPath();
    let down = false;
    for (let k = first; k <= last; k += stride) {
      const x = px(line.x.values[k]), y = py(line.y.values[k]);
      if (Number.isNaN(x + y)) { down = false; continue; }
      if (down) c.lineTo(x, y); else c.moveTo(x, y);
      down = true;
    }
    c.stroke();
  }

  at(t) {
    this.time = t;
    if (!this.place) return;
    for (const { line, marker } of this.marked) {
      const { times } = line.x, i = indexAt(times, t);
      const x = this.place[0](valueAt(times, line.x.values, i, t)), y = this.place[1](valueAt(times, line.y.values, i, t));
      const seen = this.shows(line) && x >= PHASE_PAD.left - 1 && x <= this.chart.width && y >= 0 && y <= PHASE_HEIGHT - PHASE_PAD.bottom + 1;
      marker.style.visibility = seen ? "visible" : "hidden";
      marker.style.background = line.colour();
      if (seen) marker.style.transform = `translate(${x}px, ${y}px)`;
    }
  }

  hover() {}

  tell(t) {
    for (const { line: { x, y }, value } of this.marked) {
      const i = nearestIndex(x.times, t);
      const text = during(x.times, t, this.page.longest)
        ? [x, y].map((one, axis) => told(one, one.values[i], this.turned(axis) === 1 ? null : degreesOf(one.unit))).join(", ") : "\u2013";
      if (value.textContent !== text) value.textContent = text;
    }
  }

  // To the time of the sample nearest to a point of the canvas.
  seek(x, y) {
    let least = 900, found = null;
    for (const line of this.lines.filter((one) => this.shows(one))) {
      const [first, last] = this.part(line);
      for (let k = first; k <= last; k++) {
        const away = (this.place[0](line.x.values[k]) - x) ** 2 + (this.place[1](line.y.values[k]) - y) ** 2;
        if (away < least) [least, found] = [away, line.x.times[k]];
      }
    }
    if (found !== null) this.page.seek(found);
  }
}

// The phase plot of a page's time plots, the usual pair chosen at first; null where there is nothing.
function phasePlot(page, plots, face) {
  const variables = variablesOf(plots), usual = usualPair(variables);
  if (variables.size < 2) return null;
  if (!page.phase?.every((name) => variables.has(name))) page.phase = usual ?? [...variables.keys()].slice(0, 2);
  const made = new PhasePlot(variables, page.phase, face);
  made.spec.shown = usual !== null;
  return made;
}
