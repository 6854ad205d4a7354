// Draws points, rods and curves to scale on a canvas.

const TAU = 2 * Math.PI;
const TRAIL_PARTS = 16, TRAIL_POINTS = 2000, CURVE_PARTS = 192;

class Scene {
  // model: the page's description; channels: its samples; colours(): the theme's.
  constructor(canvas, model, channels, colours) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.view = model.view;
    this.colours = colours;
    this.trail = 1;
    this.hidden = new Set();  // numbers of actors
    this.arrows = new Arrows(model.arrows);
    this.following = model.view.follow;
    this.whole = false;  // with the runs that leave the first behind
    this.actors = model.actors.map((actor, number) => {
      const places = {};
      for (const [name, at] of Object.entries(actor.places)) places[name] = channels[at];
      const circles = actor.circles.map(({ x, y, radius, holds }) => (
        { x: formula(x), y: formula(y), radius: formula(radius), holds }));
      const curves = actor.curves.map(({ x, y, s }) => ({ x: formula(x), y: formula(y), s }));
      const arrows = actor.arrows.map((arrow) => ({ ...arrow, values: arrow.values.map((at) => channels[at]) }));
      return { ...actor, number, places, circles, curves, arrows, times: channels[actor.time] };
    });
    this.zoom = 1;
    this.panX = 0;
    this.panY = 0;
    this.strip = 0;  // px at the bottom, for the legend of arrows
    this.resize();
  }

  // Fit the canvas to its box; tells whether it changed, and so is blank.
  resize() {
    const box = this.canvas.getBoundingClientRect();
    this.ratio = Math.min(window.devicePixelRatio || 1, 3);
    this.width = Math.max(box.width, 1);
    this.full = Math.max(box.height, 1);
    this.height = this.full - this.strip;
    const width = Math.round(this.width * this.ratio), height = Math.round(this.full * this.ratio);
    if (width === this.canvas.width && height === this.canvas.height) return false;
    this.canvas.width = width;
    this.canvas.height = height;
    return true;
  }

  fit() {
    this.zoom = 1;
    this.panX = this.panY = 0;
  }

  follow(on) {
    this.following = on;
    this.fit();
  }

  // Zoom by a factor about a point of the canvas, in CSS pixels; its middle by default.
  zoomBy(factor, x = this.width / 2, y = this.height / 2) {
    const zoom = Math.min(Math.max(this.zoom * factor, 0.02), 5000), applied = zoom / this.zoom;
    const dx = x - this.width / 2, dy = y - this.height / 2;
    this.panX = dx - (dx - this.panX) * applied;
    this.panY = dy - (dy - this.panY) * applied;
    this.zoom = zoom;
  }

  panBy(dx, dy) {
    this.panX += dx;
    this.panY += dy;
  }

  // The mapping of metres to CSS pixels: x * scale + left, bottom - y * scale.
  camera(frame) {
    const { frame: near, world } = this.whole ? this.view.all : this.view;
    const [x0, y0, x1, y1] = this.following ? near : world;
    const pad = 14;
    const scale = this.zoom * Math.min(
      Math.max(this.width - 2 * pad, 20) / Math.max(x1 - x0, 1e-12),
      Math.max(this.height - 2 * pad, 20) / Math.max(y1 - y0, 1e-12));
    const cx = (x0 + x1) / 2 + (this.following ? frame[0] : 0);
    const cy = (y0 + y1) / 2 + (this.following ? frame[1] : 0);
    return {
      scale,
      left: this.width / 2 + this.panX - cx * scale,
      bottom: this.height / 2 + this.panY + cy * scale,
    };
  }

  // Where everything of an actor is at time t; what is blank stays where it was last seen.
  place(actor, t) {
    const i = indexAt(actor.times, t), values = {};
    for (const [name, samples] of Object.entries(actor.places)) {
      values[name] = valueAt(actor.times, samples, i, t);
    }
    const outside = !during(actor.times, t, this.longest);
    const blank = Object.values(values).some(Number.isNaN);
    if (blank) {
      for (const [name, samples] of Object.entries(actor.places)) {
        if (!Number.isNaN(values[name])) continue;
        let k = i;
        while (k > 0 && Number.isNaN(samples[k])) k--;
        values[name] = samples[k];
        if (Number.isNaN(values[name])) values[name] = samples.find((v) => !Number.isNaN(v)) ?? 0;
      }
    }
    const point = (name) => [values[`${name} x`], values[`${name} y`]];
    return { values, outside, blank, point };
  }

  draw(t) {
    const c = this.context, colours = this.colours();
    const placed = this.actors.map((actor) => this.place(actor, t));
    const keys = this.arrows.keys(this);
    this.strip = Math.min(keys.height, this.full - 20);
    this.height = this.full - this.strip;
    const camera = this.camera(placed[0].point("frame"));
    this.drawn = { ...camera, ratio: this.ratio, time: t };
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.globalAlpha = 1;
    c.fillStyle = colours.paper;
    c.fillRect(0, 0, this.width, this.full);
    c.lineCap = c.lineJoin = "round";
    c.save();
    c.beginPath();
    c.rect(0, 0, this.width, this.height);
    c.clip();
    drawGrid(c, this, camera, colours);
    const seen = this.actors.filter(({ number }) => !this.hidden.has(number));
    for (const actor of seen) this.curves(camera, actor, placed[actor.number], placed[0], colours);
    for (const actor of seen) this.trails(camera, actor, placed[actor.number], t, colours);
    for (const actor of seen) this.bodies(camera, actor, placed[actor.number], colours);
    drawScaleBar(c, this, camera, colours);
    this.arrows.draw(this, camera, placed, t, colours);
    const blank = this.actors.filter((_, i) => placed[i].blank).map((actor) => actor.label);
    if (blank.length) {
      c.fillStyle = colours.ink;
      c.font = colours.font;
      c.textAlign = "left";
      c.fillText(`no position at this time: ${blank.join(", ")}`, 12, 22);
    }
    c.restore();
    this.arrows.legend(this, keys, colours);
    return placed;
  }

  // Circles and curves, and a mark on the origin of their frame.
  curves(camera, actor, at, first, colours) {
    const c = this.context, { scale, left, bottom } = camera;
    if (actor.number !== 0 && !this.hidden.has(0) && this.alike(actor, at, first)) return;
    c.strokeStyle = actor.number === 0 ? colours.curve : colours.actors[actor.number];
    c.globalAlpha = actor.number === 0 ? 1 : 0.55;
    c.lineWidth = actor.number === 0 ? 2.5 : 1.5;
    for (const { x, y, radius } of actor.circles) {
      const pixels = Math.min(Math.max(radius(at.values) * scale, 0), 1e7);
      c.beginPath();
      c.arc(left + x(at.values) * scale, bottom - y(at.values) * scale, pixels, 0, TAU);
      c.stroke();
    }
    for (const { x, y, s: [from, to] } of actor.curves) {
      const values = { ...at.values };
      c.beginPath();
      for (let k = 0; k <= CURVE_PARTS; k++) {
        values.s = from + (to - from) * k / CURVE_PARTS;
        c.lineTo(left + x(values) * scale, bottom - y(values) * scale);
      }
      c.stroke();
    }
    const [frameX, frameY] = at.point("frame");
    const fx = left + frameX * scale, fy = bottom - frameY * scale;
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(fx - 5, fy);
    c.lineTo(fx + 5, fy);
    c.moveTo(fx, fy - 5);
    c.lineTo(fx, fy + 5);
    c.stroke();
    c.globalAlpha = 1;
  }

  // Whether an actor's curves lie on the first one's, so that one line serves both.
  alike(actor, at, first) {
    if (actor.kind !== this.actors[0].kind) return false;
    const bodies = new Set(actor.points.flatMap(({ name }) => [`${name} x`, `${name} y`]));
    return Object.keys(at.values).every((name) => bodies.has(name)
      || Math.abs(first.values[name] - at.values[name]) * this.drawn.scale < 0.5);
  }

  trails(camera, actor, at, t, colours) {
    if (!this.trail || at.outside) return;
    const drive = Math.abs(this.view.world[2] - this.view.world[0]
      - this.view.frame[2] + this.view.frame[0]) > 1e-9;
    const paths = actor.points.map((point) => [point.name, this.colourOf(actor, point, colours)]);
    if (drive && actor.number === 0) paths.push(["frame", colours.muted]);
    for (const [name, stroke] of paths) {
      const xs = actor.places[`${name} x`], ys = actor.places[`${name} y`];
      this.trailOf(camera, actor.times, xs, ys, at.point(name), t, stroke);
    }
  }

  colourOf(actor, { light }, colours) {
    return (light ? colours.tints : colours.actors)[actor.number];
  }

  trailOf(camera, times, xs, ys, head, t, stroke) {
    const c = this.context, { scale, left, bottom } = camera;
    const end = indexAt(times, t), begin = indexAt(times, t - this.trail);
    // Few samples are joined by curves, of many some are left out; both at fixed times, so that
    // the trail does not shimmer.
    const sparse = end - begin < TRAIL_POINTS / 10;
    const stride = Math.max(1, Math.ceil((end - begin) / TRAIL_POINTS));
    const pace = 10 * this.trail / TRAIL_POINTS;
    const [from, to] = sparse ? [Math.max(t - this.trail, times[0]) / pace, t / pace]
      : [begin / stride, end / stride];
    const first = Math.ceil(from), last = Math.floor(to);
    let i = begin;
    const point = (k) => {
      if (!sparse) return [xs[k * stride], ys[k * stride]];
      const at = k * pace;
      while (i < end && times[i + 1] <= at) i++;
      while (i > 0 && times[i] > at) i--;
      return [valueAt(times, xs, i, at), valueAt(times, ys, i, at)];
    };
    c.strokeStyle = stroke;
    c.lineWidth = 2;
    c.lineCap = "butt";
    for (let part = 0; part < TRAIL_PARTS; part++) {
      const start = first + Math.floor((last - first) * part / TRAIL_PARTS);
      const stop = first + Math.floor((last - first) * (part + 1) / TRAIL_PARTS);
      const final = part === TRAIL_PARTS - 1;
      if (start === stop && !final) continue;
      c.globalAlpha = 0.75 * ((part + 1) / TRAIL_PARTS) ** 1.3;
      c.beginPath();
      let down = false;
      for (let k = start; k <= stop; k++) {
        const [x, y] = point(k);
        if (Number.isNaN(x + y)) { down = false; continue; }
        if (down) c.lineTo(left + x * scale, bottom - y * scale);
        else c.moveTo(left + x * scale, bottom - y * scale);
        down = true;
      }
      if (final && down) c.lineTo(left + head[0] * scale, bottom - head[1] * scale);
      c.stroke();
    }
    c.globalAlpha = 1;
    c.lineCap = "round";
  }

  bodies(camera, actor, at, colours) {
    const c = this.context, { scale, left, bottom } = camera;
    const places = Object.fromEntries(["frame", ...actor.points.map(({ name }) => name)].map((name) => {
      const [x, y] = at.point(name);
      return [name, [left + x * scale, bottom - y * scale]];
    }));
    // Later ones are smaller, so that two at one place both show.
    const many = this.actors.length > 1;
    const radius = many ? Math.max(11 - 3 * actor.number, 4) : 9;
    c.globalAlpha = at.outside || at.blank ? 0.45 : 1;
    const colour = colours.actors[actor.number];
    for (const circle of actor.circles) this.gap(camera, circle, at, colour);
    c.strokeStyle = many ? colour : colours.ink;
    c.lineWidth = many ? Math.max(6 - 2 * actor.number, 1.5) : 2;
    for (const [start, end] of actor.rods) {
      c.beginPath();
      c.moveTo(...places[start]);
      c.lineTo(...places[end]);
      c.stroke();
    }
    for (const point of actor.points) {
      const shape = { square: 2, round: 0 }[point.shape] ?? actor.number;
      const size = radius + ({ square: -1, round: 1 }[point.shape] ?? 0);
      this.mark(shape, ...places[point.name], size, this.colourOf(actor, point, colours), colours.paper);
    }
    c.globalAlpha = 1;
    this.pointer(...places[actor.points[0].name], colour, actor, colours);
  }

  // A line from a circle to the point that it held and that has left it.
  gap(camera, { x, y, radius, holds }, at, colour) {
    if (!holds) return;
    const c = this.context, { scale, left, bottom } = camera;
    const [px, py] = at.point(holds), cx = x(at.values), cy = y(at.values);
    const dx = px - cx, dy = py - cy, length = Math.hypot(dx, dy), size = radius(at.values);
    if (!(length > 0) || Math.abs(length - size) * scale < 1.5) return;
    const k = size / length;
    c.strokeStyle = colour;
    c.lineWidth = 1.5;
    c.setLineDash([3, 4]);
    c.beginPath();
    c.moveTo(left + px * scale, bottom - py * scale);
    c.lineTo(left + (cx + dx * k) * scale, bottom - (cy + dy * k) * scale);
    c.stroke();
    c.setLineDash([]);
  }

  // A body. Its shape tells the result apart from others as its colour does.
  mark(shape, x, y, radius, colour, rim) {
    const c = this.context;
    c.fillStyle = colour;
    c.strokeStyle = rim;
    c.lineWidth = 1.5;
    c.beginPath();
    const corners = [0, 4, 4, 3, 5, 6, 3, 8][shape % 8];
    if (corners === 0) c.arc(x, y, radius, 0, TAU);
    else {
      const turn = [0, 0, Math.PI / 4, Math.PI / 2, Math.PI / 2, 0, -Math.PI / 2, 0][shape % 8];
      for (let k = 0; k < corners; k++) {
        const angle = turn + k * TAU / corners;
        c.lineTo(x + 1.25 * radius * Math.cos(angle), y - 1.25 * radius * Math.sin(angle));
      }
      c.closePath();
    }
    c.fill();
    c.stroke();
  }

  // At the edge, where to look for a body outside the picture.
  pointer(x, y, colour, actor, colours) {
    const inset = 16;
    if (x >= 0 && y >= 0 && x <= this.width && y <= this.height) return;
    const c = this.context, mx = this.width / 2, my = this.height / 2;
    const angle = Math.atan2(y - my, x - mx);
    const k = Math.min((mx - inset) / Math.abs(x - mx), (my - inset) / Math.abs(y - my));
    const px = mx + (x - mx) * k, py = my + (y - my) * k;
    c.fillStyle = colour;
    c.beginPath();
    for (const [reach, turn] of [[12, 0], [9, 2.5], [9, -2.5]]) {
      c.lineTo(px + reach * Math.cos(angle + turn), py + reach * Math.sin(angle + turn));
    }
    c.fill();
    c.fillStyle = colours.ink;
    c.font = colours.font;
    c.textAlign = px > mx ? "right" : "left";
    c.fillText(`${actor.label} is outside`, px + (px > mx ? -18 : 18), py + 4);
  }
}
