// What a replay and a live scene do alike: look, theme, help. Both have colours, plots, a scene where
// something is drawn, and redraw().

class ScenePage {
  constructor() {
    this.told = -Infinity;
    this.colours = themeColours();
    this.frameTimes = [];
    this.degrees = false;
  }

  // Change the view of the scene and draw it.
  look(change) {
    change();
    this.dirty = true;
  }

  toggleFollow() {
    if (!this.scene) return;
    this.look(() => this.scene.follow(!this.scene.following));
    get("follow").setAttribute("aria-pressed", String(this.scene.following));
  }

  get arrows() {
    return this.scene.arrows;
  }

  nextArrows() {
    if (!this.scene) return;
    this.arrows.next();
    this.showArrows();
    const names = [...this.arrows.shown].map(({ name }) => name).join(", ");
    get("spoken").textContent = `arrows: ${names || "none"}`;
  }

  toggleDegrees() {
    this.degrees = !this.degrees;
    for (const plot of this.plots) plot.fixed = null;  // it was told in the other unit
    get("degrees").setAttribute("aria-pressed", String(this.degrees));
    this.redraw();
  }

  help() {
    const dialog = get("help");
    if (dialog.open) dialog.close(); else dialog.showModal();
  }

  nextTheme() {
    this.setTheme(THEMES[(THEMES.indexOf(this.theme) + 1) % THEMES.length]);
  }

  setTheme(theme) {
    this.theme = theme;
    applyTheme(theme);
    this.recolour();
  }

  recolour() {
    this.colours = themeColours();
    this.redraw();
  }

  // Frames a second over the last few seconds, for those who measure.
  framesPerSecond() {
    const n = this.frameTimes.length;
    return n > 1 ? 1000 * (n - 1) / (this.frameTimes[n - 1] - this.frameTimes[0]) : 0;
  }
}
