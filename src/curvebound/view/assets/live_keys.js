// The keyboard of a live page.

function liveKey(page, event) {
  if (event.ctrlKey || event.metaKey || event.altKey) {
    if (event.type === "keydown" && event.key === "z" && !typing(event)) {
      event.preventDefault();
      page.send({ do: "undo" });
    }
    return;
  }
  if (typing(event) || get("help").open) return;
  const down = event.type === "keydown";
  const { tagName, type } = event.target;
  if (!(tagName === "INPUT" && type === "range") && page.grips.key(event.key, down)) {
    event.preventDefault();
    return;
  }
  if (!down) return;
  if (event.key === " " && (tagName === "BUTTON" || tagName === "SUMMARY" || type === "checkbox")) return;
  const actions = {
    " ": () => page.toggle(), k: () => page.toggle(), ".": () => page.send({ do: "step" }),
    "[": () => page.faster(-1), "]": () => page.faster(1), 1: () => page.pace(1),
    u: () => page.send({ do: "undo" }), m: () => page.send({ do: "mark" }), b: () => page.send({ do: "back" }),
    r: () => page.send({ do: "reset" }), s: () => page.send({ do: "record" }), v: () => page.toggleBeside(),
    g: () => page.grips.next(),
    "<": () => page.nextSpan(1), ">": () => page.nextSpan(-1),
    ...page.viewKeys(),
  };
  const action = actions[event.key] ?? actions[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  action();
}

function typing({ target }) {
  return target.tagName === "SELECT" || target.tagName === "TEXTAREA"
    || (target.tagName === "INPUT" && !["range", "checkbox"].includes(target.type));
}
