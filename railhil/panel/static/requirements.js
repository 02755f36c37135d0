// The requirements of the run: a row for each sentence, as the judging code has found it.
import { fill } from "./gauges.js";

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
  fill(place, rows.map((one) => [one.id, one.title ? `${one.title}: ${one.says}` : one.says, `${MARKS[one.verdict] ?? "–"} ${word(one)}`,
    one.margin, one.instant_s === null ? "" : one.instant_s.toFixed(2), one.met]),
  ["", "", "", "n", "n", "n"], (row) => { if (row.dataset.at) onPick(Number(row.dataset.at)); });
  rows.forEach((one, at) => {
    place.children[at].dataset.at = one.instant_s ?? "";
    place.children[at].className = one.verdict === "violated" ? "rank3" : "";
  });
}
