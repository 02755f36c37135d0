// "From here with FAULT": a branch of the recorded run at the instant of the slider, and the branches made so far.
import { element } from "./gauges.js";

export class BranchForm {
  // make: called with what is asked for.
  constructor(form, make) {
    const byId = (id) => form.querySelector(`#${id}`);
    Object.assign(this, { form, run: byId("branch-run"), fault: byId("branch-fault"), button: byId("branch-make"),
      answer: byId("branch-answer"), list: byId("branches"), atS: 0, runs: [] });
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.say("");
      make({ do: "branch", run: Number(this.run.value), at_s: this.atS, fault: this.fault.value.trim() });
    });
  }

  begin(header) {
    this.runs = header.runs.map((run) => run.name);
    this.form.hidden = !header.branches;
    this.run.replaceChildren(...this.runs.map((name, at) => element("option", { value: String(at) }, name)));
    this.run.hidden = this.form.querySelector("label").hidden = this.runs.length < 2;
  }

  at(timeS) {
    this.atS = Number(timeS.toFixed(2));
    this.button.textContent = `Branch at ${timeS.toFixed(2)} s`;
  }

  say(problem) {
    this.answer.className = problem ? "bad" : "";
    this.answer.textContent = problem ? `✕ ${problem}` : "";
  }

  take({ branches, problem }) {
    const busy = branches.some((one) => !one.verdict);
    this.button.disabled = busy;
    if (problem || busy) this.say(problem);
    if (busy) this.answer.textContent = "… the branch is being made";
    else if (!problem && this.answer.textContent.startsWith("…")) this.say("");
    this.list.replaceChildren(...branches.map((one, number) => [one, number]).filter(([one]) => one.verdict).map(([one, number]) => {
      const of = this.runs.length > 1 ? `${this.runs[one.run]} ` : "", text = `${of}from ${one.at_s.toFixed(2)} s with ${one.fault}`;
      const row = element("li", {}, `${text}: ${one.verdict}${one.line ? `: ${one.line}` : ""} · `);
      if (one.report) row.append(element("a", { href: `branch/${number}`, target: "_blank", rel: "noopener" }, `report of the branch ${text}`), " · ");
      row.append(element("code", {}, one.folder));
      return row;
    }));
  }
}
