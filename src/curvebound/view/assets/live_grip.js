// Pulling: a spring from a body, or from a frame's cross, to the pointer or to where an arrow points.

const REACH = { mouse: 22, touch: 34, pen: 26 };
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

class Grips {
  // page: {scene, placed, send(command), draw()}.
  constructor(page, grips) {
    this.page = page;
    this.grips = grips;
    this.chosen = 0;
    this.ringed = false;
    this.pulling = null;  // {grip, pixel} or {grip, offset}
    this.sent = "";
    this.keys = new Set();
    if (grips.length) this.listen(get("scene"));
  }

  actor(grip) {
    return this.page.scene.actors.findIndex(({ run, component }) => (
      run === 0 && component === grip.component));
  }

  // Where a grip is in the world, m.
  place(grip) {
    const placed = this.page.placed[this.actor(grip)];
    return placed ? placed.point(grip.point) : [NaN, NaN];
  }

  pixel([x, y]) {
    const { scale, left, bottom } = this.page.scene.drawn;
    return [left + x * scale, bottom - y * scale];
  }

  world([px, py]) {
    const { scale, left, bottom } = this.page.scene.drawn;
    return [(px - left) / scale, (bottom - py) / scale];
  }

  // The grip under a point of the canvas, bodies before frames; -1 where there is none.
  at(pixel, kind) {
    const reach = REACH[kind] ?? 22;
    const away = this.grips.map((grip) => {
      const [x, y] = this.pixel(this.place(grip));
      return Math.hypot(x - pixel[0], y - pixel[1]) + (grip.force ? 0 : 1e-3);
    });
    const bodies = away.map((d, k) => [d, k]).filter(([d]) => d <= reach);
    const rank = ([d, k]) => d + (this.grips[k].force ? 0 : reach);
    return bodies.length ? bodies.sort((a, b) => rank(a) - rank(b))[0][1] : -1;
  }

  listen(canvas) {
    const local = ({ clientX, clientY }) => {
      const box = canvas.getBoundingClientRect();
      return [clientX - box.left, clientY - box.top];
    };
    let pointer = null;
    // Before the drawing's own listeners: what grips a body does not move the drawing.
    canvas.addEventListener("pointerdown", (event) => {
      const found = event.button === 0 && pointer === null ? this.at(local(event), event.pointerType) : -1;
      if (found < 0) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      pointer = event.pointerId;
      this.chosen = found;
      this.pulling = { grip: found, pixel: local(event) };
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (event.pointerId === pointer) this.pulling.pixel = local(event);
      else if (event.pointerType === "mouse") {
        canvas.classList.toggle("over-grip", this.at(local(event), "mouse") >= 0);
      }
    }, { capture: true });
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(kind, (event) => {
        if (event.pointerId !== pointer) return;
        pointer = null;
        this.release();
      }, { capture: true });
    }
    canvas.addEventListener("touchstart", (event) => {
      const touch = event.changedTouches[0];
      if (this.at(local(touch), "touch") >= 0) event.preventDefault();
    }, { passive: false });
  }

  // Arrow keys pull as long as they are held; whether the key is one.
  key(name, down) {
    if (!(name in ARROWS) || !this.grips.length) return false;
    if (down) this.keys.add(name); else this.keys.delete(name);
    this.ringed = true;
    if (this.keys.size) {
      const sum = [...this.keys].map((one) => ARROWS[one]).reduce((a, b) => [a[0] + b[0], a[1] + b[1]]);
      this.pulling = { grip: this.chosen, offset: sum };
    } else this.release();
    return true;
  }

  next() {
    if (!this.grips.length) return;
    this.release();
    this.keys.clear();
    this.chosen = this.ringed ? (this.chosen + 1) % this.grips.length : this.chosen;
    this.ringed = true;
    const { component, point } = this.grips[this.chosen];
    this.page.tellHint(`arrows pull ${point} of ${component}`);
  }

  release() {
    if (!this.pulling) return;
    this.pulling = null;
    this.sent = "";
    this.page.send({ do: "release" });
  }

  // Where the pull goes to, in the world.
  target() {
    const { grip, pixel, offset } = this.pulling;
    if (pixel) return this.world(pixel);
    const [x, y] = this.place(this.grips[grip]);
    const size = 0.5 * this.page.scene.actors[this.actor(this.grips[grip])].size;
    return [x + size * offset[0], y + size * offset[1]];
  }

  // At each picture, after the drawing: tell the server, and draw the spring and the ring.
  show(context, colours) {
    if (this.pulling) {
      const [x, y] = this.target(), { grip } = this.pulling;
      const text = `${grip} ${x} ${y}`;
      if (text !== this.sent && Number.isFinite(x + y)) {
        this.sent = text;
        this.page.send({ do: "pull", grip, x, y });
      }
      this.spring(context, this.pixel(this.place(this.grips[grip])), this.pixel([x, y]), colours);
    }
    if (this.ringed) {
      const [x, y] = this.pixel(this.place(this.grips[this.chosen]));
      context.strokeStyle = colours.ink;
      context.lineWidth = 2;
      context.setLineDash([4, 4]);
      context.beginPath();
      context.arc(x, y, 17, 0, TAU);
      context.stroke();
      context.setLineDash([]);
    }
  }

  spring(c, [x0, y0], [x1, y1], colours) {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (!(length > 1)) return;
    const nx = -(y1 - y0) / length, ny = (x1 - x0) / length, turns = 8;
    c.strokeStyle = colours.ink;
    c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(x0, y0);
    for (let k = 1; k < 2 * turns; k++) {
      const s = 0.1 + 0.8 * k / (2 * turns), side = k % 2 ? 5 : -5;
      c.lineTo(x0 + (x1 - x0) * s + side * nx, y0 + (y1 - y0) * s + side * ny);
    }
    c.lineTo(x1, y1);
    c.stroke();
    c.fillStyle = colours.ink;
    c.beginPath();
    c.arc(x1, y1, 3, 0, TAU);
    c.fill();
  }
}
