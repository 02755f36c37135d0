// The end of a run: verdict, why, scores, what it has left, and what can be done next.
import { element } from "./gauges.js";

const SIGNS = { PASS: "✓", FAIL: "✕" };

function copied(text, label) {
  const code = element("code", {}, text), button = element("button", { type: "button", "aria-label": `copy: ${label}` }, "copy");
  button.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "copied";
    } catch {
      // A browser may refuse: it is ready to be copied with the keys.
      getSelection().selectAllChildren(code);
      button.textContent = "selected";
    }
  });
  return element("span", { class: "copied" }, `${label} `, code, " ", button);
}

export class End {
  // order: called with an order, as those of the desk.
  constructor(box, desk, order) { Object.assign(this, { box, desk, order, key: "", left: null }); }

  // ended: the supervisor's report; another phase or none: no run has ended. mayOrder: this page is a desk.
  show(ended, mayOrder) {
    const is = ended?.phase === "ended", { left_s: leftS, ...rest } = ended ?? {};
    const key = is ? JSON.stringify([rest, mayOrder]) : "";
    if (key !== this.key) {
      this.key = key;
      this.box.hidden = !is;
      if (is) this.desk.hidden = true;
      this.box.replaceChildren(...(is ? this.#build(rest, mayOrder) : []));
    }
    if (this.left) this.left.textContent = leftS == null ? "" : `this page is served for ${Math.ceil(leftS)} s more`;
  }

  // The server has gone: what is shown stays, and what it would serve is a path.
  lose() {
    this.box.querySelector("a")?.replaceWith(copied(this.report, "report"));
    this.box.querySelector(".row.next")?.replaceChildren("the command has ended; the next run on this port appears here");
  }

  get isShown() { return !this.box.hidden; }

  #build({ verdict, line, scores = [], folder, report, rerun }, mayOrder) {
    this.report = report;
    const rows = scores.map(([title, value, missed]) => element("tr", { class: missed ? "missed" : "" },
      element("th", { scope: "row" }, title), element("td", { class: "n" }, value), element("td", {}, missed ? `✕ ${missed}` : "")));
    const table = element("table", {}, element("tbody", {}, ...rows));
    const left = element("p", { class: "row" }), next = element("p", { class: "row next" });
    if (report) left.append(element("a", { href: "report", target: "_blank", rel: "noopener" }, "report of the run"));
    if (folder) left.append(copied(folder, "folder"));
    if (rerun) left.append(copied(rerun, "the same run again"));
    this.left = folder && mayOrder ? element("span") : null;
    if (this.left) {
      next.append(...[["next", "▶ Next run"], ["stay", "Keep this page"], ["leave", "Close"]].map(([what, label]) => {
        const button = element("button", { type: "button", "data-end": what }, label);
        button.addEventListener("click", () => this.order({ do: what }));
        return button;
      }), this.left);
    }
    return [element("h2", { class: verdict }, `${SIGNS[verdict] ?? "!"} ${verdict}`), ...(line ? [element("p", {}, line)] : []),
      ...(rows.length ? [table] : []), left, next];
  }
}
