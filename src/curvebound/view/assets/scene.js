// Draws wires, parabolas and the bodies on them to scale on a canvas.

const TAU = 2 * Math.PI;
const TRAIL_PARTS = 16, TRAIL_POINTS = 2000;

class Scene {
  // model: the page's description; channels: its samples; colours(): the theme's.
  constructor(canvas, model, channels, colours) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.view = model.view;
    this.colours = colours;
    this.trail = 1;
    this.following = model.view.follow;
    this.actors = model.actors.map((actor, number) => {
      const places = {};
      for (const [name, at] of Object.entries(actor.places)) places[name] = channels[at];
      return { ...actor, number, places, times: channels[actor.time], last: null };
    });
    this.zoom = 1;
    this.panX = 0;
    this.panY = 0;
    this.resize();
  }

  // Fit the canvas to its box; tells whether it changed, and so is blank.
  resize() {
    const box = this.canvas.getBoundingClientRect();
    this.ratio = Math.min(window.devicePixelRatio || 1, 3);
    this.width = Math.max(box.width, 1);
    this.height = Math.max(box.height, 1);
    const width = Math.round(this.width * this.ratio), height = Math.round(this.height * this.ratio);
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
    const [x0, y0, x1, y1] = this.following ? this.view.frame : this.view.world;
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
    const i = indexAt(actor.times, t), at = {};
    for (const [name, values] of Object.entries(actor.places)) {
      at[name] = valueAt(actor.times, values, i, t);
    }
    at.outside = t > actor.times[actor.times.length - 1] || t < actor.times[0];
    at.blank = Object.values(at).some(Number.isNaN);
    if (at.blank) {
      for (const name of Object.keys(actor.places)) {
        if (!Number.isNaN(at[name])) continue;
        let k = i;
        while (k > 0 && Number.isNaN(actor.places[name][k])) k--;
        at[name] = actor.places[name][k];
        if (Number.isNaN(at[name])) at[name] = actor.places[name].find((v) => !Number.isNaN(v)) ?? 0;
      }
    }
    return at;
  }

  draw(t) {
    const c = this.context, colours = this.colours();
    const placed = this.actors.map((actor) => this.place(actor, t));
    const camera = this.camera([placed[0].frame_x, placed[0].frame_y]);
    this.drawn = { ...camera, ratio: this.ratio, time: t };
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.globalAlpha = 1;
    c.fillStyle = colours.paper;
    c.fillRect(0, 0, this.width, this.height);
    c.lineCap = c.lineJoin = "round";
    this.grid(camera, colours);
    this.actors.forEach((actor, i) => this.curve(camera, actor, placed[i], colours));
    this.actors.forEach((actor, i) => this.trails(camera, actor, placed[i], t, colours));
    this.actors.forEach((actor, i) => this.bodies(camera, actor, placed[i], colours));
    this.scaleBar(camera, colours);
    const blank = this.actors.filter((_, i) => placed[i].blank).map((actor) => actor.label);
    if (blank.length) {
      c.fillStyle = colours.ink;
      c.font = colours.font;
      c.textAlign = "left";
      c.fillText(`no position at this time: ${blank.join(", ")}`, 12, 22);
    }
    return placed;
  }

  // The length of 1, 2 or 5 times a power of ten nearest above `pixels`.
  rule(camera, pixels) {
    const least = pixels / camera.scale, power = 10 ** Math.floor(Math.log10(least));
    return power * [1, 2, 5, 10].find((k) => k * power >= least * 0.999999);
  }

  grid(camera, colours) {
    const c = this.context, step = this.rule(camera, 70);
    const first = Math.ceil(-camera.left / camera.scale / step);
    const last = Math.floor((this.width - camera.left) / camera.scale / step);
    const low = Math.ceil((camera.bottom - this.height) / camera.scale / step);
    const high = Math.floor(camera.bottom / camera.scale / step);
    c.lineWidth = 1;
    c.strokeStyle = colours.grid;
    c.beginPath();
    for (let k = first; k <= last; k++) {
      const x = Math.round(camera.left + k * step * camera.scale) + 0.5;
      c.moveTo(x, 0);
      c.lineTo(x, this.height);
    }
    for (let k = low; k <= high; k++) {
      const y = Math.round(camera.bottom - k * step * camera.scale) + 0.5;
      c.moveTo(0, y);
      c.lineTo(this.width, y);
    }
    c.stroke();
  }

  scaleBar(camera, colours) {
    const c = this.context, length = this.rule(camera, 60), pixels = length * camera.scale;
    const x = this.width - 16 - pixels, y = this.height - 16;
    c.strokeStyle = c.fillStyle = colours.muted;
    c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(x, y - 4);
    c.lineTo(x, y);
    c.lineTo(x + pixels, y);
    c.lineTo(x + pixels, y - 4);
    c.stroke();
    c.font = colours.font;
    c.textAlign = "center";
    c.fillText(`${tickText(length)} m`, x + pixels / 2, y - 7);
  }

  // The wire or the parabola, and a mark on its centre or vertex.
  curve(camera, actor, at, colours) {
    const c = this.context, { scale, left, bottom } = camera;
    const shared = actor.number === 0 || this.alike(actor, at);
    if (shared && actor.number !== 0) return;
    c.strokeStyle = actor.number === 0 ? colours.wire : colours.actors[actor.number];
    c.globalAlpha = actor.number === 0 ? 1 : 0.55;
    c.lineWidth = actor.number === 0 ? 2.5 : 1.5;
    const fx = left + at.frame_x * scale, fy = bottom - at.frame_y * scale;
    c.beginPath();
    if (actor.kind === "bead") {
      c.arc(fx, fy, Math.min(actor.size * scale, 1e7), 0, TAU);
    } else {
      const a = at.coefficient, parts = 96;
      for (let k = -parts; k <= parts; k++) {
        const u = actor.reach * k / parts;
        c.lineTo(fx + u * scale, fy - a * u * u * scale);
      }
    }
    c.stroke();
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(fx - 5, fy);
    c.lineTo(fx + 5, fy);
    c.moveTo(fx, fy - 5);
    c.lineTo(fx, fy + 5);
    c.stroke();
    c.globalAlpha = 1;
  }

  // Whether an actor's curve lies on the first one's, so that one line serves both.
  alike(actor, at) {
    const first = this.actors[0], i = indexAt(first.times, this.drawn.time);
    const same = (name) => {
      const value = valueAt(first.times, first.places[name], i, this.drawn.time);
      return Math.abs(value - at[name]) * this.drawn.scale < 0.5;
    };
    return actor.kind === first.kind && Math.abs(actor.size - first.size) < 1e-6 * first.size
      && same("frame_x") && same("frame_y") && (actor.kind === "bead" || same("coefficient"));
  }

  trails(camera, actor, at, t, colours) {
    if (!this.trail || at.outside) return;
    const colour = colours.actors[actor.number];
    const drive = Math.abs(this.view.world[2] - this.view.world[0]
      - this.view.frame[2] + this.view.frame[0]) > 1e-9;
    const paths = actor.kind === "bead"
      ? [["body_x", "body_y", colour]]
      : [["body_x", "body_y", colour], ["bob_x", "bob_y", colours.bobs[actor.number]]];
    if (drive && actor.number === 0) paths.push(["frame_x", "frame_y", colours.muted]);
    for (const [x, y, stroke] of paths) {
      this.trailOf(camera, actor.times, actor.places[x], actor.places[y], [at[x], at[y]], t, stroke);
    }
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
    const colour = colours.actors[actor.number];
    const x = left + at.body_x * scale, y = bottom - at.body_y * scale;
    // Later ones are smaller, so that two at one place both show.
    const many = this.actors.length > 1;
    const radius = many ? Math.max(11 - 3 * actor.number, 4) : 9;
    c.globalAlpha = at.outside || at.blank ? 0.45 : 1;
    if (actor.kind === "bead") {
      this.gap(camera, actor, at, colour);
      this.mark(actor.number, x, y, radius, colour, colours.paper);
    } else {
      const bx = left + at.bob_x * scale, by = bottom - at.bob_y * scale;
      c.strokeStyle = many ? colour : colours.ink;
      c.lineWidth = many ? Math.max(6 - 2 * actor.number, 1.5) : 2;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(bx, by);
      c.stroke();
      this.mark(2, x, y, radius - 1, colour, colours.paper);
      this.mark(0, bx, by, radius + 1, colours.bobs[actor.number], colours.paper);
    }
    c.globalAlpha = 1;
    this.pointer(x, y, colour, actor, colours);
  }

  // A line from the wire to a bead that has left it.
  gap(camera, actor, at, colour) {
    const c = this.context, { scale, left, bottom } = camera;
    const dx = at.body_x - at.frame_x, dy = at.body_y - at.frame_y, length = Math.hypot(dx, dy);
    if (!(length > 0) || Math.abs(length - actor.size) * scale < 1.5) return;
    const k = actor.size / length;
    c.strokeStyle = colour;
    c.lineWidth = 1.5;
    c.setLineDash([3, 4]);
    c.beginPath();
    c.moveTo(left + at.body_x * scale, bottom - at.body_y * scale);
    c.lineTo(left + (at.frame_x + dx * k) * scale, bottom - (at.frame_y + dy * k) * scale);
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
