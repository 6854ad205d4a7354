// Opens the connection; the first message is the scene.

function liveMain() {
  addEventListener("error", (event) => complain(event.error ?? event.message));
  addEventListener("unhandledrejection", (event) => complain(event.reason));
  const socket = new WebSocket(`ws://${location.host}${location.pathname}socket`);
  socket.binaryType = "arraybuffer";
  let page = null;
  socket.addEventListener("message", ({ data }) => {
    if (page) return page.hear(data);
    const { event, ...told } = JSON.parse(data);
    if (event !== "scene") return complain(told.text);
    page = window.curvebound = new LivePage(socket, told);
    document.documentElement.dataset.ready = "true";
    return undefined;
  });
  socket.addEventListener("close", () => complain("the connection to curvebound has ended: is it still running? Load the page anew"));
}

liveMain();
