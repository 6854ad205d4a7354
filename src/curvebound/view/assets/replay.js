// The page: puts clock, drawing, plots and controls together.

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
class Page extends ScenePage {
  constructor(model, channels) {
    super();
    this.model = model;
    this.channels = channels;
    const start = Math.min(...model.results.map((result) => result.start));
    const end = Math.max(...model.results.map((result) => result.end));
    this.player = new Player(start, end, () => this.changed());
    // Single frames are the samples of the result that has most of them.
    const finest = model.results.reduce((a, b) => (b.samples > a.samples ? b : a));
    this.frames = channels[finest.time];
    this.timeText = timeFormatter(this.frames);
    this.window = [start, end];
    this.hovered = null;
    this.many = model.actors.length > 1;
    this.buildNotes();
    buildAbout(model);
    if (model.actors.length) {
      this.scene = new Scene(get("scene"), model, channels, () => this.colours);
      this.scene.longest = this.player.length;
      this.buildLegend();
      buildArrows(this);
      listenScene(this);
    } else {
      get("stage").hidden = true;
    }
    this.buildReadouts();
    this.buildPlots();
    buildControls(this);
    this.setTheme("auto");
    this.readHash();
    const observer = new ResizeObserver(() => this.resized());
    observer.observe(get("plots"));
    if (this.scene) observer.observe(get("scene"));
    this.changed();
    requestAnimationFrame((now) => this.frame(now));
  }

  // ---- time -------------------------------------------------------------------------------

  frame(now) {
    this.frameTimes.push(now);
    if (this.frameTimes.length > 240) this.frameTimes.shift();
    const before = this.player.time;
    this.player.advance(now);
    if (this.player.time !== before) this.dirty = true;
    if (this.dirty) {
      this.dirty = false;
      this.show(now);
    }
    requestAnimationFrame((next) => this.frame(next));
  }

  show(now) {
    const t = this.player.time;
    if (this.scene) this.scene.draw(t);
    this.keepInWindow(t);
    for (const plot of this.plots) plot.at(t);
    if (document.activeElement !== get("scrub") || this.player.playing) get("scrub").value = t;
    get("clock").textContent = `${this.timeText(t)} s`;
    // Digits that change at every frame cannot be read.
    if (now - this.told > 100 || !this.player.playing) {
      this.told = now;
      this.tell();
    }
  }

  tell() {
    const t = this.hovered ?? this.player.time;
    for (const plot of this.plots) if (plot.chart) plot.tell(t);
    for (const one of this.cells) {
      const { cell, times, values } = one, { time, length } = this.player;
      const text = during(times, time, length) ? told(one, values[nearestIndex(times, time)], this.degrees ? degreesOf(one.unit) : null)
        : time > times[0] ? "ended" : "\u2013";
      if (cell.textContent !== text) cell.textContent = text;
    }
    get("scrub").setAttribute("aria-valuetext", `${this.timeText(this.player.time)} seconds`);
  }

  // The player has started, stopped or jumped.
  changed() {
    const { playing, speed, loop, time } = this.player;
    const still = !(this.player.length > 0);
    const button = get("play");
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
    button.title = playing ? "Pause (space)" : "Play (space)";
    button.dataset.state = playing ? "playing" : "paused";
    for (const id of ["play", "back", "forth", "start", "scrub"]) get(id).disabled = still;
    get("speed").value = String(speed);
    get("loop").setAttribute("aria-pressed", String(loop));
    if (!playing) this.announce(time);
    this.dirty = true;
  }

  // Tells a screen reader where the replay stands, once it rests.
  announce(time) {
    clearTimeout(this.saying);
    this.saying = setTimeout(() => {
      const parts = this.cells.slice(0, 4).map(({ name, cell }) => `${name} ${cell.textContent}`);
      this.say(`${this.timeText(time)} seconds. ${parts.join(", ")}`);
    }, 400);
  }

  // One sample on or back; a jump of k seconds of the wall's time.
  step(by) {
    this.player.pause();
    const { time } = this.player, i = indexAt(this.frames, time);
    let k = i + by;
    if (by < 0 && this.frames[i] < time - 1e-12) k += 1;
    while (by > 0 && k < this.frames.length - 1 && this.frames[k] <= time) k++;
    while (by < 0 && k > 0 && this.frames[k] >= time) k--;
    this.player.seek(this.frames[Math.min(Math.max(k, 0), this.frames.length - 1)]);
  }

  tapped() { this.player.toggle(); }

  faster(by) {
    const at = SPEEDS.findIndex((speed) => speed >= this.player.speed * 0.999);
    this.player.pace(SPEEDS[Math.min(Math.max((at < 0 ? 6 : at) + by, 0), SPEEDS.length - 1)]);
  }

  toggleLoop() {
    this.player.loop = !this.player.loop;
    this.changed();
  }

  // ---- range of the plots -----------------------------------------------------------------

  range() {
    const [from, to] = this.window;
    return to > from ? [from, to] : [from - 0.5, to + 0.5];
  }

  zoomTime(factor, about = this.player.time) {
    const { start, end, length } = this.player, [from, to] = this.window;
    const span = Math.min((to - from) / factor, length);
    const share = Math.min(Math.max((about - from) / (to - from || 1), 0), 1);
    let first = about - share * span;
    first = Math.min(Math.max(first, start), end - span);
    if (span > length * 1e-7) this.setWindow(first, first + span);
  }

  setWindow(from, to) {
    if (from === this.window[0] && to === this.window[1]) return;
    this.window = [from, to];
    for (const plot of this.plots) plot.refresh();
    get("time-all").disabled = from <= this.player.start && to >= this.player.end;
    this.dirty = true;
  }

  // Turns the page when the playhead leaves the plots.
  keepInWindow(t) {
    const [from, to] = this.window, span = to - from;
    if (t >= from && t <= to) return;
    const { start, end } = this.player;
    const first = t > to ? Math.min(t - 0.02 * span, end - span) : t - 0.98 * span;
    const begin = Math.max(Math.min(first, t), start);
    this.setWindow(begin, begin + span);
  }

  hover(t) {
    this.hovered = t;
    for (const plot of this.plots) plot.hover(t);
    this.told = -Infinity;
    this.dirty = true;
  }

  // ---- parts of the page ------------------------------------------------------------------

  buildNotes() {
    const { notes } = this.model;
    if (!notes.length) return;
    get("notes").hidden = false;
    for (const note of notes) get("notes").append(element("p", note));
  }

  buildLegend() {
    if (!this.many) return;
    for (const actor of this.model.actors) get("legend").append(legendEntry(actor, (shown) => this.hide(actor, !shown)));
    get("legend").hidden = false;
  }

  // Take a result out of drawing and plots, or back.
  hide(actor, hidden) {
    if (hidden) this.scene.hidden.add(actor.number); else this.scene.hidden.delete(actor.number);
    this.redraw();
  }

  buildReadouts() {
    this.cells = [];
    const { readouts, actors } = this.model, table = get("readouts");
    if (!readouts.length) {
      get("panel").hidden = true;
      return;
    }
    get("upper").classList.toggle("stacked", actors.length > 2);
    if (this.many) {
      const row = element("tr");
      row.append(element("th", "", { scope: "col" }));
      actors.forEach((actor, k) => {
        const head = element("th", "", { scope: "col" });
        head.append(element("i", undefined, { "aria-hidden": "true", class: `dot ${shaped(actor)} c${k}` }));
        head.append(actor.label);
        row.append(head);
      });
      table.append(row);
    }
    for (const { label, unit, error, cells } of readouts) {
      const row = element("tr");
      row.append(element("th", label, { scope: "row" }));
      cells.forEach((one, k) => {
        const cell = element("td", one ? "" : "\u2013");
        row.append(cell);
        if (!one) return;
        const values = this.channels[one.values];
        const name = this.many ? `${actors[k].label} ${label}` : label;
        const format = formatter(values, error);
        this.cells.push({ cell, name, times: this.channels[one.time], values, unit, format });
      });
      table.append(row);
    }
  }

  buildPlots() {
    const page = {
      name: this.model.title, hides: (actor) => this.scene?.hidden.has(actor) ?? false, degrees: () => this.degrees,
      colours: () => this.colours, many: this.many, longest: this.player.length,
      range: () => this.range(), seek: (t) => this.player.seek(t), hover: (t) => this.hover(t),
      zoomTime: (factor, t) => this.zoomTime(factor, t),
    };
    this.plots = this.model.plots.map((spec) => new TimePlot(spec, this.channels, page));
    const phase = phasePlot(this, this.plots, page);
    if (phase) this.plots.push(phase);
    const chooser = get("chooser");
    disclose(get("choose"), chooser);
    this.plots.forEach((plot, k) => {
      const box = element("input", undefined, { type: "checkbox", id: `plot-${k}` });
      box.checked = plot.spec.shown;
      const label = element("label", plot.spec.title, { for: `plot-${k}` });
      label.prepend(box);
      chooser.append(label);
      plot.element.hidden = !plot.spec.shown;
      box.addEventListener("change", () => {
        plot.element.hidden = !box.checked;
        if (box.checked) plot.mount();
        this.tell();
      });
      get("plots").append(plot.element);
    });
    get("plot-area").hidden = !this.plots.length;
  }

  fit() {
    if (this.scene) this.look(() => this.scene.fit());
  }

  // ---- look -------------------------------------------------------------------------------

  // Text that grows makes the page longer; only another width changes what is drawn.
  resized() {
    const width = get("plots").clientWidth;
    if (this.scene && this.scene.resize()) this.scene.draw(this.player.time);
    if (width !== this.plotsWidth) {
      this.plotsWidth = width;
      this.redraw();
    }
  }

  redraw() {
    for (const plot of this.plots) if (!plot.element.hidden) plot.mount();
    if (this.scene) this.scene.draw(this.player.time);
    this.dirty = true;
    this.told = -Infinity;
  }

  // The address may say how to begin: #t=1.5&speed=0.5&play=0&theme=dark
  readHash() {
    const wish = new URLSearchParams(location.hash.slice(1));
    const number = (name) => Number.parseFloat(wish.get(name));
    if (THEMES.includes(wish.get("theme"))) this.setTheme(wish.get("theme"));
    if (number("speed") > 0) this.player.pace(number("speed"));
    if (Number.isFinite(number("t"))) this.player.seek(number("t"));
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (wish.get("play") === "1" || (wish.get("play") !== "0" && !calm)) this.player.play();
  }
}

async function main() {
  window.addEventListener("error", (event) => complain(event.error ?? event.message));
  window.addEventListener("unhandledrejection", (event) => complain(event.reason));
  if (typeof DecompressionStream === "undefined") {
    complain("this browser is too old: Chrome 80, Firefox 113 or Safari 16.4 and later can");
    return;
  }
  const model = JSON.parse(get("model").textContent);
  model.actors.forEach((actor, number) => { actor.number = number; });
  const channels = decodeChannels(model.channels, await unpack("samples"));
  get("samples").textContent = "";
  window.curvebound = new Page(model, channels);
  document.documentElement.dataset.ready = "true";
}

main();
