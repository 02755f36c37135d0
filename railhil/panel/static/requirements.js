// The requirements of the run: a row for each sentence, as the judging code has found it.
import { element } from "./gauges.js";

const MARKS = { kept: "✓", violated: "✕" };
// What is not decided yet while the run goes on.
const SO_FAR = { kept: "kept so far", open: "not decided yet", "says nothing": "not met yet" };

// box: a section with the table. onPick: called with the instant of a row that is chosen.
export function showRequirements(box, { rows, said, so_far: soFar }, onPick) {
  const word = (row) => (soFar && SO_FAR[row.verdict]) || row.verdict, place = box.querySelector("tbody"), counts = {};
  for (const row of rows) counts[word(row)] = (counts[word(row)] ?? 0) + 1;
  box.hidden = !rows.length;
  box.querySelector(".counts").textContent = `${Object.entries(counts).map(([name, count]) => `${count} ${name}`).join(", ")}`;
  box.querySelector(".said").textContent = said;
  while (place.childElementCount > rows.length) place.lastChild.remove();
  while (place.childElementCount < rows.length) {
    const row = element("tr", { tabindex: "0" }), go = () => { if (row.dataset.at) onPick(Number(row.dataset.at)); };
    for (const name of ["", "", "", "n", "n", "n"]) row.append(element("td", { class: name }));
    row.addEventListener("click", go);
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") go(); });
    place.append(row);
  }
  rows.forEach((one, at) => {
    const row = place.children[at], instant = one.instant_s === null ? "" : one.instant_s.toFixed(2);
    const cells = [one.id, one.title ? `${one.title}: ${one.says}` : one.says, `${MARKS[one.verdict] ?? "–"} ${word(one)}`,
      one.margin, instant, String(one.met)];
    row.dataset.at = one.instant_s ?? "";
    row.className = one.verdict === "violated" ? "rank3" : "";
    cells.forEach((cell, which) => { if (row.children[which].textContent !== cell) row.children[which].textContent = cell; });
  });
}
