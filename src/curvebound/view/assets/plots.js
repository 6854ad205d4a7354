// Time plots on uPlot.

const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

class TimePlot {
  // spec: a plot of the model; page: {name, colours, range(), seek(t), hover(t), many, hides(actor),
  // degrees(), longest}, the last as of `during`.
  constructor(spec, channels, page) {
    this.spec = spec;
    this.page = page;
    this.logarithmic = false;
    const many = new Set(spec.series.map((one) => one.actor)).size > 1;
    const owners = new Set(spec.series.map((one) => one.owner)).size > 1;
    const labels = [...new Set(spec.series.map((one) => one.label))];
    const oneLabel = labels.length === 1;
    this.series = spec.series.map((one, k) => ({
      ...one,
      times: channels[one.time],
      values: channels[one.values],
      text: owners ? (oneLabel ? one.owner : `${one.owner}: ${one.label}`) : one.label,
      colour: many || page.many ? () => page.colours().actors[one.actor]
        : () => page.colours().actors[k % 8],
      dash: DASHES[(many || page.many ? labels.indexOf(one.label) : k) % DASHES.length],
    }));
    for (const one of this.series) one.format = formatter(one.values, spec.error);
    this.off = new Set();
    this.whole = false;
    this.build();
    this.judge();
  }

  build() {
    const { spec } = this;
    this.element = document.createElement("section");
    this.element.className = "plot";
    this.element.setAttribute("aria-label", this.describe());
    const head = document.createElement("header");
    const title = document.createElement("h3");
    title.textContent = spec.title;
    this.unit = element("span", "", { class: "unit" });
    title.append(this.unit);
    head.append(title);
    const button = (text, words, action) => {
      const made = element("button", text, { type: "button", class: "small", title: words });
      made.setAttribute("aria-label", `${words}: ${spec.title}`);
      made.addEventListener("click", action);
      head.append(made);
      return made;
    };
    const toggle = (text, words, name) => {
      const made = button(text, words, () => {
        this[name] = !this[name];
        this.fixed = null;
        made.setAttribute("aria-pressed", String(this[name]));
        this.mount();
      });
      made.setAttribute("aria-pressed", "false");
      return made;
    };
    if (spec.error) toggle("log", "Logarithmic axis of the magnitude", "logarithmic");
    else this.all = toggle("all", "All of a run that leaves the others behind", "whole");
    button("\u2212", "Zoom out in y", () => this.zoomY(0.5));
    button("+", "Zoom in in y", () => this.zoomY(2));
    button("PNG", "Save as PNG", () => (
      download(plotPicture(this, this.page.colours()), fileName(this.page.name, spec.title))));
    this.legend = document.createElement("ul");
    this.legend.className = "legend";
    this.cells = this.series.map((one) => {
      const item = document.createElement("li"), swatch = document.createElement("canvas");
      const switching = element("button", undefined, { type: "button", class: "entry", "aria-pressed": "true", title: "Show or hide" });
      swatch.width = 44;
      swatch.height = 12;
      swatch.setAttribute("aria-hidden", "true");
      const label = document.createElement("span"), value = document.createElement("output");
      label.textContent = one.text;
      switching.append(swatch, label);
      switching.addEventListener("click", () => {
        if (!this.off.delete(one)) this.off.add(one);
        switching.setAttribute("aria-pressed", String(!this.off.has(one)));
        this.mount();
      });
      item.append(switching, value);
      this.legend.append(item);
      return { swatch, value };
    });
    this.box = document.createElement("div");
    this.box.className = "chart";
    this.box.setAttribute("aria-hidden", "true");
    this.element.append(head, this.box, this.legend);
  }

  // For those who cannot see it: from where to where each series goes.
  describe() {
    const unit = prettyUnit(this.spec.unit);
    const parts = this.series.map((one) => {
      let low = Infinity, high = -Infinity;
      for (const value of one.values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
      const range = low <= high ? `from ${one.format(low)} to ${one.format(high)} ${unit}` : "blank";
      return `${one.text} ${range}`;
    });
    return `${this.spec.title} over time: ${parts.join("; ")}`;
  }

  // Whether a run leaves the others behind.
  judge() {
    if (this.spec.error) return;
    this.bounds = boundsOf(this.series);
    this.all.hidden = !this.bounds;
  }

  // What the legend of a picture tells.
  get lines() {
    return this.series;
  }

  shows(one) {
    return !this.off.has(one) && !this.page.hides(one.actor);
  }

  // Angles are told in degrees where the page wishes.
  turned(one) {
    return this.page.degrees() ? degreesOf(one.unit) : null;
  }

  heading() {
    const unit = prettyUnit(this.turned(this.spec) ?? this.spec.unit);
    return this.spec.title + (unit ? ` ${unit}` : "");
  }

  // Draw anew: at first, and when size, theme or kind of axis change.
  mount() {
    if (this.chart) this.chart.destroy();
    const width = Math.max(this.box.clientWidth, 160), height = 170;
    const colours = this.page.colours();
    this.swatches();
    this.unit.textContent = this.heading().slice(this.spec.title.length);
    const axis = { stroke: colours.muted, grid: { stroke: colours.grid, width: 1 },
                   ticks: { stroke: colours.grid, width: 1, size: 4 }, font: colours.font };
    const values = (_, ticks) => ticks.map((tick) => (tick === null ? "" : tickText(tick)));
    this.chart = new uPlot({
      width, height,
      pxAlign: 0,
      legend: { show: false },
      cursor: { show: false },
      padding: [8, 22, 0, 0],
      scales: {
        x: { time: false, range: () => this.page.range() },
        y: this.logarithmic ? { distr: 3, range: (_, low, high) => this.fixed ?? logRange(low, high) } : { range: (_, low, high) => this.linear(low, high) },
      },
      axes: [
        { ...axis, size: 24, gap: 4, values: (_, t) => t.map((x) => `${tickText(x)} s`), space: 60 },
        { ...axis, size: 66, gap: 4, space: 26, values },
      ],
      series: [{}, ...this.series.map((one) => {
        // Later ones are thinner, so that two on one line both show.
        const stroke = { dash: one.dash, width: this.page.many ? Math.max(3 - one.actor, 1.2) : 1.5 };
        return {
          ...stroke, stroke: one.colour, spanGaps: false, show: this.shows(one), paths: lineOf(stroke),
          // of one sample only, which no line shows; a live run has one when it begins
          points: { show: () => this.series.every(({ times }) => times.length === 1), size: 7 },
        };
      })],
    }, this.data(width), this.box);
    this.playhead = document.createElement("div");
    this.playhead.className = "playhead";
    this.ghost = document.createElement("div");
    this.ghost.className = "playhead ghost";
    this.chart.over.append(this.ghost, this.playhead);
    this.span = this.chart.bbox.width / devicePixelRatio;
    this.listen(this.chart.over);
    this.at(this.time ?? this.page.range()[0]);
  }

  swatches() {
    this.cells.forEach(({ swatch }, k) => {
      const c = swatch.getContext("2d");
      c.clearRect(0, 0, 44, 12);
      c.strokeStyle = this.series[k].colour();
      c.lineWidth = 4;
      c.setLineDash(this.series[k].dash.map((length) => length * 1.6));
      c.beginPath();
      c.moveTo(0, 6);
      c.lineTo(44, 6);
      c.stroke();
    });
  }

  data(width) {
    const [from, to] = this.page.range();
    const data = decimate(this.series, from, to, Math.max(width - 88, 80));
    if (this.turned(this.spec)) {
      const turn = (value) => (typeof value === "number" ? value * DEGREE : value);
      return [data[0], ...data.slice(1).map((values) => values.map(turn))];
    }
    if (!this.logarithmic) return data;
    const size = (value) => (typeof value === "number" ? Math.abs(value) || null : value);
    return [data[0], ...data.slice(1).map((values) => values.map(size))];
  }

  // A factor about a share of the height, from below; from then on the axis stays as it is.
  zoomY(factor, share = 0.5) {
    const { min, max } = this.chart.scales.y, by = this.logarithmic ? Math.log10 : (value) => value;
    const back = this.logarithmic ? (value) => 10 ** value : (value) => value;
    const [low, high] = [by(min), by(max)], about = low + share * (high - low);
    if (!((high - low) / factor > 1e-12 * Math.max(Math.abs(low), Math.abs(high)))) return;
    this.setY([back(about - (about - low) / factor), back(about + (high - about) / factor)]);
  }

  // Moves by a share of the height.
  panY(share) {
    const { min, max } = this.chart.scales.y;
    if (this.logarithmic) this.setY([min * (max / min) ** share, max * (max / min) ** share]);
    else this.setY([min + share * (max - min), max + share * (max - min)]);
  }

  // The ends of the y axis; null for those of what is shown.
  setY(ends) {
    this.fixed = ends;
    this.refresh();
  }

  linear(low, high) {
    if (this.fixed) return this.fixed;
    if (!this.bounds || this.whole || low === null || high === null) return linearRange(low, high);
    const [from, to] = this.bounds.map((bound) => bound * (this.turned(this.spec) ? DEGREE : 1));
    return low > to || high < from ? linearRange(low, high)
      : linearRange(Math.max(low, from), Math.min(high, to));
  }

  // The range of time has changed.
  refresh() {
    if (this.chart) this.chart.setData(this.data(this.chart.width));
    if (this.chart && this.time !== undefined) this.move(this.playhead, this.time);
  }

  at(t) {
    this.time = t;
    if (this.chart) this.move(this.playhead, t);
  }

  hover(t) {
    if (!this.chart) return;
    this.ghost.classList.toggle("on", t !== null);
    if (t !== null) this.move(this.ghost, t);
  }

  move(line, t) {
    const [from, to] = this.page.range();
    // Nothing is read from the page here: that would lay it out anew at every frame.
    const x = (t - from) / (to - from) * this.span, off = !(t >= from && t <= to);
    line.style.transform = `translateX(${x}px)`;
    if (line.off !== off) line.classList.toggle("off", line.off = off);
  }

  // Numbers in the legend, those of the sample nearest to t.
  tell(t) {
    this.cells.forEach(({ value }, k) => {
      const one = this.series[k], { times, values } = one;
      const text = during(times, t, this.page.longest) ? told(one, values[nearestIndex(times, t)], this.turned(one)) : "\u2013";
      if (value.textContent !== text) value.textContent = text;
    });
  }

  listen(over) {
    const time = (event) => {
      const box = over.getBoundingClientRect(), [from, to] = this.page.range();
      return from + (to - from) * (event.clientX - box.left) / box.width;
    };
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      this.grasped = event.clientY;
      if (!event.shiftKey) this.page.seek(time(event));
    });
    over.addEventListener("pointermove", (event) => {
      if (over.hasPointerCapture(event.pointerId)) {
        if (event.shiftKey) this.panY((event.clientY - this.grasped) / over.clientHeight);
        else this.page.seek(time(event));
        this.grasped = event.clientY;
      }
      else if (event.pointerType === "mouse") this.page.hover(time(event));
    });
    over.addEventListener("pointerleave", () => this.page.hover(null));
    over.addEventListener("dblclick", () => this.setY(null));
    over.addEventListener("wheel", (event) => {
      if (event.shiftKey) {
        event.preventDefault();
        const box = over.getBoundingClientRect(), turn = event.deltaY || event.deltaX;
        this.zoomY(Math.exp(-turn / 300), (box.bottom - event.clientY) / box.height);
        return;
      }
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.page.zoomTime(Math.exp(-event.deltaY / 300), time(event));
    }, { passive: false });
  }
}

function linearRange(low, high) {
  if (low === null || high === null || !Number.isFinite(low + high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  // What is constant but for rounding is drawn as a straight line, not as noise.
  const span = high - low, least = 1e-9 * size;
  const pad = span > least ? 0.08 * span : size > 0 ? 0.1 * size : 1;
  return [low - pad, high + pad];
}

function logRange(low, high) {
  if (low === null || high === null || !(low > 0)) return [1e-3, 1];
  return [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high) + 1e-9)];
}
