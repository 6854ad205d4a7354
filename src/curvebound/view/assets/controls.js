// Keyboard, mouse and touch.

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
    l: () => page.toggleLoop(), d: () => page.nextTheme(), "?": () => page.help(),
    "<": () => page.zoomTime(0.5), ">": () => page.zoomTime(2),
    a: () => page.setWindow(player.start, player.end),
  };
  if (page.scene) {
    Object.assign(actions, {
      f: () => page.look(() => page.scene.fit()), c: () => page.toggleFollow(),
      t: () => page.nextTrail(),
      "+": () => page.look(() => page.scene.zoomBy(1.4)),
      "=": () => page.look(() => page.scene.zoomBy(1.4)),
      "-": () => page.look(() => page.scene.zoomBy(1 / 1.4)),
    });
  }
  const action = actions[event.key] ?? actions[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  action();
}

// Mouse: drag moves, ctrl and wheel zoom. Touch: two fingers move and zoom. A tap plays or pauses.
function listenScene(page) {
  const canvas = get("scene"), fingers = new Map();
  let travelled = 0, most = 0;
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (!fingers.size) travelled = most = 0;
    fingers.set(event.pointerId, local(event));
    most = Math.max(most, fingers.size);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = local(event), dx = now[0] - before[0], dy = now[1] - before[1];
    travelled += Math.hypot(dx, dy);
    fingers.set(event.pointerId, now);
    if (event.pointerType === "touch" && fingers.size < 2) return;
    const others = [...fingers].filter(([id]) => id !== event.pointerId);
    page.look(() => {
      if (others.length) {
        const [x, y] = others[0][1];
        const grown = Math.hypot(now[0] - x, now[1] - y) / Math.hypot(before[0] - x, before[1] - y);
        if (Number.isFinite(grown) && grown > 0) page.scene.zoomBy(grown, x, y);
      } else page.scene.panBy(dx, dy);
    });
  });
  const lift = (event) => {
    fingers.delete(event.pointerId);
    if (event.type === "pointerup" && !fingers.size && most === 1 && travelled < 6) {
      page.player.toggle();
    }
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("dblclick", () => page.look(() => page.scene.fit()));
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    page.look(() => page.scene.zoomBy(Math.exp(-event.deltaY / 300), ...local(event)));
  }, { passive: false });
}
