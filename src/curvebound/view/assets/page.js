// What a replay and a live scene do alike: look, theme, help. Both have colours, plots, a scene where
// something is drawn, its name, fit() and redraw().

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

  // Where a run leaves the first one far behind, the drawing shows that one, or all.
  toggleAll() {
    const { scene } = this;
    if (!scene?.view.all) return;
    scene.whole = !scene.whole;
    this.look(() => scene.fit());
    this.offerAll();
  }

  offerAll() {
    get("see-all").hidden = !this.scene?.view.all;
    get("see-all").setAttribute("aria-pressed", String(this.scene?.whole ?? false));
  }

  nextTrail() {
    const select = get("trail");
    select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
    select.dispatchEvent(new Event("change"));
  }

  // The buttons that both have; what is drawn may come later, or never.
  buildView() {
    const on = (id, action) => get(id).addEventListener("click", action);
    on("theme", () => this.nextTheme());
    on("help-button", () => this.help());
    on("degrees", () => this.toggleDegrees());
    on("zoom-in", () => this.zoom(1.4));
    on("zoom-out", () => this.zoom(1 / 1.4));
    on("fit", () => this.fit());
    on("see-all", () => this.toggleAll());
    on("follow", () => this.toggleFollow());
    get("trail").addEventListener("change", () => this.look(() => { this.scene.trail = Number(get("trail").value); }));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolour());
  }

  // And the keys for them.
  viewKeys() {
    return {
      d: () => this.nextTheme(), o: () => this.toggleDegrees(), "?": () => this.help(), f: () => this.fit(),
      c: () => this.toggleFollow(), t: () => this.nextTrail(), w: () => this.nextArrows(), e: () => this.toggleAll(),
      "+": () => this.zoom(1.4), "=": () => this.zoom(1.4), "-": () => this.zoom(1 / 1.4),
    };
  }

  zoom(factor) {
    if (this.scene) this.look(() => this.scene.zoomBy(factor));
  }

  get arrows() {
    return this.scene.arrows;
  }

  nextArrows() {
    if (!this.scene) return;
    this.arrows.next();
    this.showArrows();
    const names = [...this.arrows.shown].map(({ name }) => name).join(", ");
    this.say(`arrows: ${names || "none"}`);
  }

  // Tells a screen reader at once; what it was to be told later would hide it.
  say(text) {
    clearTimeout(this.saying);
    get("spoken").textContent = text;
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
