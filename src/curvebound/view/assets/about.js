// What the results show, and the settings in which they differ.

function buildAbout({ about, results }) {
  const box = get("about");
  if (about.text) box.append(element("span", about.text), " ");
  for (const [name, href] of Object.entries(about.links)) box.append(element("a", name, { href }), " ");
  box.hidden = !box.childNodes.length;
  if (!about.differing.length) return;
  const table = get("differing"), head = element("tr");
  head.append(element("th", "setting", { scope: "col" }));
  for (const { label } of results) head.append(element("th", label, { scope: "col" }));
  table.append(head);
  for (const { path, unit, values } of about.differing) {
    const row = element("tr");
    row.append(element("th", path, { scope: "row" }));
    for (const value of values) {
      const text = typeof value === "number" ? String(Number(value.toPrecision(6))).replace("-", MINUS) : String(value);
      row.append(element("td", withUnit(text, unit)));
    }
    table.append(row);
  }
  get("differences").hidden = false;
}
