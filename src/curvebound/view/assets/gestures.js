// The hand on the drawing.

// Mouse: drag moves, ctrl and wheel zoom. Touch: two fingers move and zoom. A tap is the page's.
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
      page.tapped();
    }
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("dblclick", () => page.fit());
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    page.look(() => page.scene.zoomBy(Math.exp(-event.deltaY / 300), ...local(event)));
  }, { passive: false });
}
