// Buttons and keyboard.

function buildControls(page) {
  const { player } = page, scrub = get("scrub");
  scrub.min = player.start;
  scrub.max = player.end;
  scrub.step = "any";
  get("end").textContent = `/ ${page.timeText(player.end)} s`;
  for (const speed of SPEEDS) get("speed").append(element("option", `${speed}\u00d7`, { value: speed }));
  const on = (id, action) => get(id).addEventListener("click", action);
  on("play", () => player.toggle());
  on("back", () => page.step(-1));
  on("forth", () => page.step(1));
  on("start", () => player.seek(player.start));
  on("loop", () => page.toggleLoop());
  on("time-in", () => page.zoomTime(2));
  on("time-out", () => page.zoomTime(0.5));
  on("time-all", () => page.setWindow(player.start, player.end));
  page.buildView();
  scrub.addEventListener("input", () => player.seek(Number(scrub.value)));
  get("speed").addEventListener("change", () => player.pace(Number(get("speed").value)));
  if (page.scene) {
    get("follow").setAttribute("aria-pressed", String(page.scene.following));
    page.offerAll();
    on("picture", () => download(page.scene.canvas, fileName(page.model.title, page.timeText(player.time))));
  }
  document.addEventListener("keydown", (event) => pressed(page, event));
  document.addEventListener("visibilitychange", () => player.anchor());
}

function pressed(page, event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const tag = event.target.tagName;
  // Buttons, lists and boxes keep the keys that are theirs.
  if (tag === "SELECT" || get("help").open) return;
  if (event.key === " " && (tag === "BUTTON" || tag === "SUMMARY" || event.target.type === "checkbox")) return;
  const { player } = page, big = Math.max(player.length / 100, 1e-9);
  const actions = {
    " ": () => player.toggle(), k: () => player.toggle(),
    ArrowLeft: () => (event.shiftKey ? player.seek(player.time - big) : page.step(-1)),
    ArrowRight: () => (event.shiftKey ? player.seek(player.time + big) : page.step(1)),
    Home: () => player.seek(player.start), End: () => player.seek(player.end),
    "[": () => page.faster(-1), "]": () => page.faster(1), 1: () => player.pace(1),
    l: () => page.toggleLoop(),
    "<": () => page.zoomTime(0.5), ">": () => page.zoomTime(2),
    a: () => page.setWindow(player.start, player.end), ...page.viewKeys(),
  };
  const action = actions[event.key] ?? actions[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  action();
}
