// The parts of a live page that depend on which runs there are.

function buildLegend(page, actors) {
  const legend = get("legend");
  legend.replaceChildren();
  legend.hidden = !page.many;
  for (const actor of actors) {
    legend.append(legendEntry(actor, (shown) => {
      if (shown) page.scene.hidden.delete(actor.number); else page.scene.hidden.add(actor.number);
      page.redraw();
    }));
  }
}

// How far each body of the second run is from the first one's: a channel of the second.
function distancesOf({ samples: [first, second] }) {
  if (!second) return [];
  return second.actors.flatMap((actor, k) => actor.points.map(({ name }) => {
    const other = first.actors[k];
    const source = second.derive((row) => {
      const t = second.times[row], times = first.view(first.times);
      if (!during(times, t)) return NaN;
      const i = indexAt(times, t);
      const [dx, dy] = ["x", "y"].map((axis) => (
        valueAt(times, first.view(other.places[`${name} ${axis}`]), i, t) - actor.places[`${name} ${axis}`][row]));
      return Math.hypot(dx, dy);
    });
    return { component: actor.component, label: name, source, samples: second };
  }));
}

// A formatter from what a run beforehand had, since here nothing has been seen yet.
function scaled([low, high], error = false) {
  return formatter([low, high, 0.5001 * (low + high)], error);
}

function buildLivePlots(page, actors) {
  const face = {
    name: page.model.name, hides: (actor) => page.scene?.hidden.has(actor) ?? false, degrees: () => page.degrees,
    colours: () => page.colours, many: page.many, range: () => page.range(), seek: () => {},
    hover: (t) => page.hover(t), zoomTime: (factor) => page.nextSpan(factor > 1 ? -1 : 1),
  };
  const colourOf = (run, component) => {
    const found = actors.findIndex((actor) => actor.run === run && actor.component === component);
    return found >= 0 ? found : Math.max(actors.findIndex((actor) => actor.run === run), 0);
  };
  const several = new Set(page.model.columns.map((name) => name.split(".")[0])).size > 1;
  const owner = (run, component) => (page.runs.length > 1
    ? page.runs[run].label + (page.runs[run].actors.length > 1 ? ` ${component}` : "") : several ? component : "");
  const specs = page.model.plots.map((plot) => ({
    ...plot,
    series: page.runs.flatMap((_, run) => plot.series.map((one) => ({
      ...one, actor: colourOf(run, one.component), owner: owner(run, one.component), time: 0, values: 0,
      samples: page.samples[run], source: page.samples[run].columns[one.column + 1],
    }))),
  }));
  if (page.distances.length) {
    specs.unshift({
      title: `Distance from ${page.runs[0].label}`, unit: "m", shown: true, error: true,
      series: page.distances.map((one) => ({
        ...one, actor: colourOf(1, one.component), owner: owner(1, one.component), unit: "m", time: 0, values: 0,
        scale: [0, 1.5],
      })),
    });
  }
  const shown = new Map(page.plots.map((plot) => [plot.spec.title, !plot.element.hidden]));
  page.watcher?.disconnect();
  for (const plot of page.plots) plot.chart?.destroy();
  get("plots").replaceChildren();
  get("chooser").replaceChildren();
  // Plots out of sight cost nothing.
  page.watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      page.plots.find((plot) => plot.element === target).away = !isIntersecting;
    }
    page.dirty = true;
  });
  const none = new Float64Array(0);
  page.plots = specs.map((spec) => {
    const plot = new TimePlot(spec, [none], face);
    for (const one of plot.series) one.format = scaled(one.scale, spec.error);
    plot.element.setAttribute("aria-label", `${spec.title} over time`);
    return plot;
  });
  const phase = phasePlot(page, page.plots, face);
  if (phase) page.plots.push(phase);
  page.plots.forEach((plot, k) => {
    const { spec } = plot;
    plot.element.hidden = !(shown.get(spec.title) ?? spec.shown);
    const box = element("input", undefined, { type: "checkbox", id: `plot-${k}` });
    box.checked = !plot.element.hidden;
    const label = element("label", spec.title, { for: `plot-${k}` });
    label.prepend(box);
    get("chooser").append(label);
    box.addEventListener("change", () => {
      plot.element.hidden = !box.checked;
      if (box.checked) plot.mount();
      page.dirty = true;
    });
    get("plots").append(plot.element);
    page.watcher.observe(plot.element);
  });
}

function buildLiveReadouts(page) {
  const table = get("readouts"), { readouts } = page.model;
  table.replaceChildren();
  table.className = page.runs.length > 1 ? "several" : "one";
  page.cells = [];
  get("panel").hidden = !readouts.length;
  const several = new Set(readouts.map(({ component }) => component)).size > 1;
  if (page.runs.length > 1) {
    const head = element("tr");
    head.append(element("th", "", { scope: "col" }));
    for (const run of page.runs) head.append(element("th", run.label, { scope: "col" }));
    table.append(head);
  }
  const row = (name, cells) => {
    const line = element("tr");
    line.append(element("th", name, { scope: "row" }));
    for (const one of cells) {
      const cell = element("td", one ? "" : "\u2013");
      line.append(cell);
      if (one) page.cells.push({ cell, name, ...one });
    }
    table.append(line);
  };
  const blank = page.samples.slice(1).map(() => null);
  for (const { component, label, source, samples } of page.distances) {
    const name = several ? `${component} ${label} apart` : `${label} apart`;
    row(name, [...blank, { samples, source, unit: "m", format: scaled([0, 1.5], true) }]);
  }
  for (const one of readouts) {
    const format = scaled(one.scale, one.error);
    row(several ? `${one.component} ${one.name}` : one.name, page.samples.map((samples) => (
      { samples, source: samples.columns[one.column + 1], unit: one.unit, format })));
  }
}

function buildLiveControls(page) {
  get("inputs").open = innerWidth > 820;  // on a phone they are long
  for (const speed of SPEEDS) get("speed").append(element("option", `${speed}\u00d7`, { value: speed }));
  const on = (id, action) => get(id).addEventListener("click", action);
  for (const name of ["reset", "step", "undo", "mark", "back", "record"]) on(name, () => page.send({ do: name }));
  on("play", () => page.toggle());
  on("beside", () => page.toggleBeside());
  disclose(get("choose"), get("chooser"));
  on("picture", () => download(page.scene.canvas, fileName(page.model.name, page.time.toFixed(2))));
  page.buildView();
  get("speed").addEventListener("change", () => page.pace(Number(get("speed").value)));
  get("span").addEventListener("change", () => page.look(() => {}));
  for (const kind of ["keydown", "keyup"]) document.addEventListener(kind, (event) => liveKey(page, event));
  addEventListener("blur", () => { page.grips.keys.clear(); page.grips.release(); });
  const observer = new ResizeObserver(() => page.resized());
  observer.observe(get("plots"));
  observer.observe(get("scene"));
}
