// The clock of the replay: seconds of the result against seconds of the wall.

class Player {
  constructor(start, end, onChange) {
    this.start = start;
    this.end = end;
    this.time = start;
    this.speed = 1;
    this.loop = true;
    this.playing = false;
    this.onChange = onChange;
  }

  get length() {
    return this.end - this.start;
  }

  // Time and pace are anchored together, so that no rounding of frames adds up.
  anchor(now = performance.now()) {
    this.anchored = [now, this.time];
  }

  advance(now) {
    if (!this.playing) return;
    let time = this.anchored[1] + Math.max(now - this.anchored[0], 0) / 1000 * this.speed;
    if (time >= this.end) {
      if (this.loop) {
        time = this.start + (time - this.start) % this.length;
        this.time = time;
        this.anchor(now);
      } else {
        time = this.end;
        this.playing = false;
        this.onChange();
      }
    }
    this.time = time;
  }

  play() {
    if (this.playing || !(this.length > 0)) return;
    if (this.time >= this.end) this.time = this.start;
    this.playing = true;
    this.anchor();
    this.onChange();
  }

  pause() {
    if (!this.playing) return;
    this.advance(performance.now());
    this.playing = false;
    this.onChange();
  }

  toggle() {
    if (this.playing) this.pause(); else this.play();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.anchor();
    this.onChange();
  }

  pace(speed) {
    this.advance(performance.now());
    this.speed = speed;
    this.anchor();
    this.onChange();
  }
}
