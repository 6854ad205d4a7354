// Arrows of velocities and forces, for those who ask for them. What they mean is declared with the
// drawings; those of one unit share a scale, that of the greatest on show.

const ARROW_REACH = 0.22;  // of the smaller side of the canvas, for the greatest
const ARROW_CUT = 2;       // times that: what is longer is cut there, and dashed
const ARROW_KEY = { left: 12, gap: 8, apart: 18, line: 18 };  // pixels
const ARROW_COLOURS = [6, 7, 4, 5, 3, 2, 1, 0];  // those that bodies take last

class Arrows {
  // kinds: {name, symbol, unit, size, lacks, drawn}, as the page's model tells them.
  constructor(kinds) {
    this.kinds = kinds.map((kind, k) => ({ ...kind, colour: ARROW_COLOURS[k % 8] }));
    this.shown = new Set();
  }

  kindOf([name, unit]) {
    return this.kinds.find((kind) => kind.name === name && kind.unit === unit);
  }

  // The arrows that begin with a key: none, those of each unit, all.
  steps() {
    const drawn = this.kinds.filter((kind) => kind.drawn);
    const units = [...new Set(drawn.map(({ unit }) => unit))];
    const steps = [[], ...units.map((unit) => drawn.filter((kind) => kind.unit === unit))];
    return units.length > 1 ? [...steps, drawn] : steps;
  }

  next() {
    const steps = this.steps(), shown = this.kinds.filter((kind) => this.shown.has(kind));
    const at = steps.findIndex((step) => step.length === shown.length && step.every((kind) => this.shown.has(kind)));
    this.shown = new Set(steps[(at + 1) % steps.length]);
  }

  // The sizes of what has been lately.
  fit(actors) {
    for (const kind of this.kinds) {
      let size = 0;
      for (const { arrows, times } of actors) {
        for (const { kind: key, values: [xs, ys] } of arrows) {
          if (this.kindOf(key) !== kind) continue;
          for (let k = Math.max(times.length - 1200, 0); k < times.length; k++) size = Math.max(size, Math.hypot(xs[k], ys[k]) || 0);
        }
      }
      kind.size = size || kind.size;
    }
  }

  // Pixels for one of each unit.
  scales(scene) {
    const reach = ARROW_REACH * Math.min(scene.width, scene.full), scales = new Map();
    for (const { unit } of this.shown) {
      const sizes = [...this.shown].filter((kind) => kind.unit === unit).map(({ size }) => size);
      scales.set(unit, reach / (Math.max(...sizes) || 1));
    }
    return scales;
  }

  draw(scene, camera, placed, t, colours) {
    if (!this.shown.size) return;
    const c = scene.context, scales = this.scales(scene);
    const longest = ARROW_CUT * ARROW_REACH * Math.min(scene.width, scene.full);
    for (const actor of scene.actors) {
      const at = placed[actor.number];
      if (scene.hidden.has(actor.number) || at.outside) continue;
      for (const { kind: key, at: point, values: [xs, ys] } of actor.arrows) {
        const kind = this.kindOf(key);
        if (!this.shown.has(kind)) continue;
        const x = heldAt(actor.times, xs, t), y = heldAt(actor.times, ys, t), scale = scales.get(kind.unit);
        const length = Math.hypot(x, y) * scale, [px, py] = at.point(point);
        if (!(length >= 2)) continue;
        const begin = [camera.left + px * camera.scale, camera.bottom - py * camera.scale];
        const drawn = Math.min(length, longest), along = [x * scale / length, -y * scale / length];
        shaft(c, begin, along, drawn, { colour: colours.actors[kind.colour], paper: colours.paper, cut: drawn < length });
        const text = drawn < length ? `${kind.symbol} \u00d7${(length / drawn).toPrecision(2)}` : kind.symbol;
        letter(c, text, begin[0] + along[0] * (drawn + 9), begin[1] + along[1] * (drawn + 9), colours);
      }
    }
  }

  // An arrow of a round number of each kind, with its name, in lines for a strip below the drawing.
  keys(scene) {
    if (!this.shown.size) return { rows: [], height: 0 };
    const c = scene.context, scales = this.scales(scene), rows = [];
    let x = ARROW_KEY.left, line = 0;
    c.font = scene.colours().font;
    for (const kind of this.kinds.filter((one) => this.shown.has(one))) {
      const value = ruleOf({ scale: scales.get(kind.unit) }, 24), pixels = value * scales.get(kind.unit);
      const text = `${kind.symbol} ${kind.name}, ${withUnit(tickText(value), kind.unit)}`;
      const width = pixels + ARROW_KEY.gap + c.measureText(text).width;
      if (x > ARROW_KEY.left && x + width > scene.width - ARROW_KEY.left) [x, line] = [ARROW_KEY.left, line + 1];
      rows.push({ kind, pixels, text, x, line });
      x += width + ARROW_KEY.apart;
    }
    return { rows, height: ARROW_KEY.line * (line + 1) + 8 };
  }

  legend(scene, { rows }, colours) {
    if (!rows.length) return;
    const c = scene.context;
    c.fillStyle = colours.grid;
    c.fillRect(0, scene.height, scene.width, 1);
    c.font = colours.font;
    c.textAlign = "left";
    for (const { kind, pixels, text, x, line } of rows) {
      const y = scene.height + 4 + ARROW_KEY.line * (line + 0.5);
      shaft(c, [x, y], [1, 0], pixels, { colour: colours.actors[kind.colour], paper: colours.paper, cut: false });
      c.fillStyle = colours.ink;
      c.fillText(text, x + pixels + ARROW_KEY.gap, y + 4);
    }
  }
}

// Forces jump with what is held over a step: no curve goes through them.
function heldAt(times, values, t) {
  const i = indexAt(times, t), next = Math.min(i + 1, times.length - 1), span = times[next] - times[i];
  const share = span > 0 ? Math.min(Math.max((t - times[i]) / span, 0), 1) : 0;
  return share === 0 ? values[i] : values[i] + share * (values[next] - values[i]);
}

function shaft(c, [x, y], [ax, ay], length, { colour, paper, cut }) {
  const head = Math.min(9, 0.6 * length), tip = [x + ax * length, y + ay * length];
  const neck = [tip[0] - ax * head, tip[1] - ay * head];
  const outline = () => {
    c.beginPath();
    c.moveTo(x, y);
    c.lineTo(...neck);
    c.stroke();
  };
  const point = () => {
    c.beginPath();
    c.moveTo(...tip);
    c.lineTo(neck[0] - ay * head * 0.5, neck[1] + ax * head * 0.5);
    c.lineTo(neck[0] + ay * head * 0.5, neck[1] - ax * head * 0.5);
    c.closePath();
  };
  c.strokeStyle = paper;
  c.lineWidth = 5;
  outline();
  c.lineWidth = 3;
  point();
  c.stroke();
  c.strokeStyle = c.fillStyle = colour;
  c.lineWidth = 2.5;
  c.lineCap = "butt";
  c.setLineDash(cut ? [8, 4] : []);
  outline();
  c.setLineDash([]);
  c.lineCap = "round";
  point();
  c.fill();
}

function letter(c, symbol, x, y, colours) {
  c.font = `600 ${colours.font}`;
  c.textAlign = "center";
  c.lineWidth = 3;
  c.strokeStyle = colours.paper;
  c.strokeText(symbol, x, y + 4);
  c.fillStyle = colours.ink;
  c.fillText(symbol, x, y + 4);
}

// Boxes in the row under the drawing; page.look draws, page.say is for those who hear the page.
function buildArrows(page) {
  const { arrows } = page, row = get("arrows");
  disclose(get("arrows-button"), row);
  if (!arrows.kinds.length) row.append(element("span", "Nothing here is declared to have arrows."));
  const boxes = arrows.kinds.map((kind, k) => {
    const box = element("input", undefined, { type: "checkbox", id: `arrow-${k}` });
    const label = element("label", undefined, { for: `arrow-${k}` });
    const lacks = kind.lacks.length ? `: ${kind.lacks.join("; ")}` : "";
    label.append(box, element("i", undefined, { "aria-hidden": "true", class: `dot c${kind.colour}` }),
      element("span", `${kind.name} (${kind.symbol}, ${prettyUnit(kind.unit)})`), element("span", lacks, { class: "lack" }));
    box.disabled = !kind.drawn;
    box.addEventListener("change", () => {
      if (box.checked) arrows.shown.add(kind); else arrows.shown.delete(kind);
      page.look(() => {});
    });
    row.append(label);
    return box;
  });
  page.showArrows = () => {
    boxes.forEach((box, k) => { box.checked = arrows.shown.has(arrows.kinds[k]); });
    page.look(() => {});
  };
}
