// The page of a live scene: what the server sends, drawn; what the hand does, sent.

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10];
const MOST_NOTES = 4;
const KEPT = ["view", "whole", "zoom", "panX", "panY", "trail", "following", "arrows"];  // of a scene where others run

class LivePage extends ScenePage {
  constructor(socket, model) {
    super();
    this.socket = socket;
    this.model = model;
    this.state = { playing: false, speed: 1, time: model.start };
    this.runs = [];
    this.samples = [];
    this.placed = [];
    this.plots = [];
    this.arrived = { at: performance.now(), time: model.start };
    this.time = model.start;
    this.beginning = true;
    this.half = 0;
    get("about").textContent = model.description ? `\u2013 ${model.description}` : "";
    this.grips = new Grips(this, model.grips);
    this.ranges = new Ranges(get("controls"), model.controls, (path, value) => this.send({ do: "set", path, value }));
    this.settings = new Settings(get("settings"), model.settings, model.variants, {
      restart: (settings) => this.send({ do: "restart", settings }),
      original: () => this.send({ do: "original" }),
      beside: (label, settings) => this.send({ do: "beside", label, settings }),
      variant: (name) => this.send({ do: "variant", name }),
    });
    const frames = model.grips.some(({ force }) => !force);
    this.tellHint(model.grips.length ? `drag a body${frames ? " or the cross of a frame" : ""}` : "");
    for (const note of model.notes) this.note(note);
    buildLiveControls(this);
    if (model.view) listenScene(this); else get("stage").hidden = true;
    this.setTheme("auto");
    requestAnimationFrame((now) => this.frame(now));
  }

  send(command) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(command));
  }

  // ---- what the server says ---------------------------------------------------------------

  hear(data) {
    if (typeof data !== "string") return this.take(new Float64Array(data));
    const { event, ...told } = JSON.parse(data);
    ({
      runs: () => this.begin(told),
      state: () => this.stand(told),
      cut: () => this.cut(told),
      pace: () => {
        get("pace").textContent = told.late ? `the machine keeps up with ${told.speed.toPrecision(2)}\u00d7 only` : "";
      },
      error: () => this.note(told.text),
      refused: () => this.note(told.text),
      note: () => this.note(told.text),
      recorded: () => this.note(`Saved: ${told.scene} and ${told.result}; ${told.exact
        ? "running the scene gave the same bits." : "running the scene did NOT give the same bits."}`),
    })[event]?.();
  }

  take(numbers) {
    const samples = this.samples[numbers[0]], width = this.model.columns.length + 1;
    if (!samples) return;
    if (numbers[0] === 0) this.arrived = { at: performance.now(), time: numbers[1] };
    for (let k = 2; k < numbers.length; k += width) samples.push(numbers.subarray(k, k + width));
    this.dirty = true;
  }

  // Other runs than before; `kept`: the first goes on.
  begin({ runs, kept }) {
    this.runs = runs;
    const fresh = runs.map((run) => new Samples(run, this.model.columns.length));
    if (kept && this.samples[0]) fresh[0] = this.samples[0];
    this.samples = fresh;
    if (!kept) this.time = this.model.start;
    get("beside").setAttribute("aria-pressed", String(runs.length > 1));
    this.settings.show(runs[0].settings);
    const before = this.scene;
    const actors = runs.flatMap((run, number) => fresh[number].actors.map((actor) => (
      { ...actor, run: number, label: this.labelOf(actor, number), time: 0 })));
    actors.forEach((actor, number) => { actor.number = number; });
    this.many = actors.length > 1;
    if (this.model.view) {
      const plain = actors.map((actor) => ({ ...actor, places: {}, arrows: [] }));
      const model = { view: this.model.view, actors: plain, arrows: this.model.arrows };
      this.scene = new Scene(get("scene"), model, [fresh[0].times], () => this.colours);
      this.scene.actors.forEach((actor, k) => {
        actor.sources = actors[k].places;
        actor.arrows = actors[k].arrows;
        actor.growing = actors[k].curves.map((curve, i) => ({ ...curve, drawn: actor.curves[i] }))
          .filter(({ grows }) => grows);
      });
      if (before) for (const name of KEPT) this.scene[name] = before[name];
      else buildArrows(this);
      get("follow").setAttribute("aria-pressed", String(this.scene.following));
    }
    buildLegend(this, actors);
    this.distances = distancesOf(this);
    buildLivePlots(this, actors);
    buildLiveReadouts(this);
    this.redraw();
  }

  labelOf(actor, number) {
    const one = this.runs[number].actors.length === 1;
    if (this.runs.length === 1) return actor.component;
    return one ? this.runs[number].label : `${this.runs[number].label}: ${actor.component}`;
  }

  stand(state) {
    this.state = state;
    // What the server said before it heard of the last change is not taken back to.
    if (state.speed === this.wanted) this.wanted = null;
    else if (this.wanted) state.speed = this.wanted;
    const button = get("play");
    button.setAttribute("aria-label", state.playing ? "Pause" : "Run");
    button.title = state.playing ? "Pause (space)" : "Run (space)";
    button.dataset.state = state.playing ? "playing" : "paused";
    button.disabled = get("step").disabled = !state.alive;
    get("speed").value = String(state.speed);
    get("undo").disabled = !state.undo;
    get("mark").disabled = !this.model.canGoBack;
    get("back").disabled = state.mark === null;
    get("back").title = state.mark === null ? "Back to the marked state (b)" : `Back to ${state.mark.toFixed(2)} s (b)`;
    if (state.catching_up) get("pace").textContent = "catching up";
    else if (!state.playing) get("pace").textContent = "";
    this.ranges.show(state.values);
    if (!state.playing) this.announce();
    this.dirty = true;
    if (this.beginning) {
      this.beginning = false;
      const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
      const wish = new URLSearchParams(location.hash.slice(1)).get("play");
      if (wish === "1" || (wish !== "0" && !calm)) this.send({ do: "play" });
    }
  }

  cut({ run, time }) {
    this.samples[run]?.cut(time);
    this.time = Math.min(this.time, time);
    if (run === 0) this.arrived = { at: performance.now(), time };
    this.dirty = true;
  }

  note(text) {
    const box = get("notes"), line = element("p"), close = element("button", "Close", { type: "button", class: "small" });
    if ([...box.querySelectorAll("span")].some((one) => one.textContent === text)) return;
    line.append(element("span", text), close);
    close.addEventListener("click", () => {
      line.remove();
      box.hidden = !box.children.length;
    });
    box.append(line);
    while (box.children.length > MOST_NOTES) box.firstChild.remove();
    box.hidden = false;
  }

  tellHint(text) {
    get("hint").textContent = text;
    this.say(text);
  }

  // ---- time -------------------------------------------------------------------------------

  // The time to draw: smooth between messages, a little behind the last sample.
  timeAt(now) {
    const last = this.samples[0]?.last ?? this.model.start;
    if (!this.state.playing) return last;
    const behind = this.model.step + 0.01 * this.state.speed;
    const smooth = this.arrived.time + (now - this.arrived.at) / 1000 * this.state.speed - behind;
    return Math.min(Math.max(smooth, this.time), last);
  }

  frame(now) {
    this.frameTimes.push(now);
    if (this.frameTimes.length > 240) this.frameTimes.shift();
    if (this.dirty || this.state.playing || this.grips.pulling) {
      this.dirty = false;
      this.show(now);
    }
    requestAnimationFrame((next) => this.frame(next));
  }

  show(now) {
    if (!this.samples[0]?.length) return;
    this.time = this.timeAt(now);
    if (this.scene) {
      for (const actor of this.scene.actors) {
        const samples = this.samples[actor.run];
        actor.times = samples.view(samples.times);
        for (const [name, values] of Object.entries(actor.sources)) actor.places[name] = samples.view(values);
        for (const arrow of actor.arrows) arrow.values = arrow.sources.map((values) => samples.view(values));
      }
      if (this.scene.actors.every((actor) => actor.times.length)) {
        this.placed = this.scene.draw(this.time);
        growCurves(this);
        this.grips.show(this.scene.context, this.colours);
      }
    }
    // While the scene runs half of the plots at each picture: they cost more than the drawing does.
    this.half = 1 - this.half;
    const seen = this.plots.filter((plot) => !plot.element.hidden && plot.chart && !plot.away);
    for (const plot of seen.filter((_, k) => !this.state.playing || k % 2 === this.half)) {
      for (const one of plot.series) {
        one.times = one.samples.view(one.samples.times);
        one.values = one.samples.view(one.source);
      }
      plot.time = this.time;
      plot.refresh();
    }
    if (now - this.told > 100 || !this.state.playing) {
      this.told = now;
      get("clock").textContent = `${this.time.toFixed(2)} s`;
      this.tell();
    }
  }

  tell() {
    if (this.scene) this.showView(this.scene.view);
    for (const plot of this.plots.filter(({ chart, element }) => chart && !element.hidden)) {
      plot.judge();
      plot.tell(this.hovered ?? this.time);
    }
    for (const one of this.cells) {
      const { cell, samples, source } = one, times = samples.view(samples.times);
      const value = times.length ? source[nearestIndex(times, this.time)] : NaN;
      const text = told(one, value, this.degrees ? degreesOf(one.unit) : null);
      if (cell.textContent !== text) cell.textContent = text;
    }
  }

  // Show this view, and offer all where that is more: at once, for the next key may come before the next picture.
  showView(view) {
    const all = allOf(this, view);
    this.scene.view = { ...view, all };
    this.scene.whole &&= Boolean(all);
    this.offerAll();
  }

  announce() {
    clearTimeout(this.saying);
    this.saying = setTimeout(() => {
      const parts = this.cells.slice(0, 4).map(({ name, cell }) => `${name} ${cell.textContent}`);
      this.say(`${this.time.toFixed(2)} seconds. ${parts.join(", ")}`);
    }, 400);
  }

  range() {
    const span = Number(get("span").value), { start } = this.model;
    const end = Math.max(this.time, start + span);
    return [end - span, end];
  }

  // ---- the hand ---------------------------------------------------------------------------

  // The next key may come before the server's answer.
  toggle() {
    this.send({ do: this.state.playing ? "pause" : "play" });
    this.state.playing = !this.state.playing;
  }

  tapped() {
    this.toggle();
  }

  pace(value) {
    this.send({ do: "speed", value });
    this.state.speed = this.wanted = value;
  }

  faster(by) {
    const at = SPEEDS.findIndex((speed) => speed >= this.state.speed * 0.999);
    this.pace(SPEEDS[Math.min(Math.max(at + by, 0), SPEEDS.length - 1)]);
  }

  // The settings that the form has, else the scene's first variant; alone again where there is one.
  toggleBeside() {
    if (this.runs.length > 1) return this.send({ do: "alone" });
    const changed = this.settings.changed(), now = this.runs[0].settings;
    const [variant] = this.model.variants;
    if (JSON.stringify(changed) !== JSON.stringify(now)) {
      return this.send({ do: "beside", label: this.settings.label(), settings: changed });
    }
    if (variant !== undefined) return this.send({ do: "variant", name: variant });
    get("restarting").open = true;
    return this.tellHint("change a start value or a setting, then press Beside");
  }

  fit() {
    if (!this.scene) return;
    this.scene.whole = false;
    this.showView(fittedView(this));
    this.arrows.fit(this.scene.actors);
    this.look(() => this.scene.fit());
  }

  nextSpan(by) {
    const select = get("span");
    select.selectedIndex = Math.min(Math.max(select.selectedIndex + by, 0), select.options.length - 1);
    select.dispatchEvent(new Event("change"));
  }

  hover(t) {
    this.hovered = t;
    for (const plot of this.plots) plot.hover(t);
  }

  // ---- look -------------------------------------------------------------------------------

  resized() {
    const width = get("plots").clientWidth;
    if (this.scene) this.scene.resize();
    if (width !== this.plotsWidth) {
      this.plotsWidth = width;
      this.redraw();
    }
    this.dirty = true;
  }

  redraw() {
    for (const plot of this.plots) if (!plot.element.hidden) plot.mount();
    this.dirty = true;
    this.told = -Infinity;
  }
}
