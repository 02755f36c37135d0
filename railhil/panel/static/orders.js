// The operator's orders: start, pause, stop, pace, the safety loop, and faults. Each ends as a SUP_CMD on the bus.
import { FaultForm } from "./fault_form.js";
import { element } from "./gauges.js";

const byId = (id) => document.getElementById(id);
// Where the tab keeps the token.
export const TOKEN = "railhil-token";
const EMERGENCY = "safety_loop off";
// What railhil run --catalogue has prepared.
const CATALOGUED = / @manual .*\bcombine id (\S+)$/;
const shortFault = (text) => text.replace(" @manual", "").replace(/ combine( id \S+)?$/, "");

// The duration that is typed, for a fault that is injected now.
function duration() {
  const text = byId("lasts").value.trim();
  return text ? { for_s: Number(text) } : {};
}

export class Orders {
  // send: called with a message for the server.
  constructor(send) {
    // Answers reach every page: each has numbers of its own.
    Object.assign(this, { send, token: "", number: 1000 * Math.floor(1e9 * Math.random()), answers: new Map(), operator: null });
    this.form = new FaultForm(byId("own"), () => send({ kinds: true }), (text) => { byId("fault").value = text; });
    byId("start").addEventListener("click", () => this.order({ do: "start" }, "start"));
    byId("pause").addEventListener("click", () => this.order({ do: "pause" }, "pause"));
    byId("stop").addEventListener("click", () => this.order({ do: "stop" }, "stop"));
    byId("emergency").addEventListener("click", () => this.order({ do: "inject", fault: this.emergency }, "emergency"));
    byId("reset").addEventListener("click", () => this.order({ do: "clear", fault: this.emergency }, "reset"));
    byId("pace").addEventListener("change", () => this.order({ do: "pace", pace: Number(byId("pace").value) }, "pace"));
    byId("desk").addEventListener("submit", (event) => {
      event.preventDefault();
      const { for_s: lasts } = duration(), typed = byId("fault").value.trim();
      const text = lasts === undefined || / for /.test(typed) ? typed : `${typed} for ${lasts}s`;
      this.order({ do: "fault", text }, text);
    });
  }

  begin(header) {
    byId("desk").hidden = !header.commands;
    // Who has the token is at the desk: the end of the run waits for this page.
    if (header.commands && this.token) this.send({ token: this.token, do: "hello" });
    if (!this.token) byId("answer").textContent = "○ this page watches: orders need the address that the command has printed";
  }

  // The token is that of another command: this page watches.
  forget() {
    sessionStorage.removeItem(TOKEN);
    this.token = "";
    this.show(this.operator);
  }

  // said: what the page says when the order is taken.
  order(document, said) {
    this.number += 1;
    this.answers.set(this.number, said);
    byId("answer").textContent = "";
    this.send({ token: this.token, id: this.number, ...document });
  }

  answer({ answer, refused }) { if (this.answers.has(answer)) this.say(refused, this.answers.get(answer)); }

  say(refused, said = "") {
    const box = byId("answer");
    box.className = refused ? "bad" : "";
    box.textContent = refused ? `✕ ${refused}` : said ? `✓ ${said}` : "";
  }

  // Number of the fault that opens the safety loop; 0: there is none.
  get emergency() {
    return (this.operator?.faults ?? []).findIndex((text) => text.startsWith(EMERGENCY)) + 1;
  }

  // operator: the supervisor's report; null or undefined: none is known.
  show(operator) {
    this.operator = operator;
    const phase = this.token ? operator?.phase ?? "" : "", faults = operator?.faults ?? [], emergency = this.emergency;
    const runs = phase === "running" || phase === "paused", waits = phase === "waiting", may = (id, on, why) => {
      byId(id).disabled = !on;
      if (why !== undefined) byId(id).title = why;
    };
    may("start", waits || phase === "paused");
    may("pause", phase === "running" && operator.lockstep,
      operator && !operator.lockstep ? "in real time nothing can stand still" : "pause (P)");
    may("stop", runs);
    may("emergency", runs && emergency > 0, emergency ? "open the safety loop (E)" : "no safety loop is prepared in this run");
    may("reset", runs && emergency > 0);
    may("pace", (runs || waits) && operator.lockstep);
    byId("pace-of").hidden = Boolean(operator) && operator.lockstep === false;
    const prepared = faults.map((text, at) => [text, at + 1]).filter(([text]) => CATALOGUED.test(text));
    const can = waits || (runs && prepared.length > 0);
    may("add", can, can ? "" : runs ? "this run has no further faults: they are added before Start" : "no run takes faults now");
    byId("add").textContent = runs ? "Inject" : "Add";
    byId("fault").disabled = byId("lasts").disabled = !can;
    byId("own").hidden = !can;
    if (operator?.pace !== undefined && document.activeElement !== byId("pace")) byId("pace").value = String(operator.pace);
    this.#showFaults(faults, prepared, runs);
  }

  #showFaults(faults, prepared, runs) {
    const { active = [], injected = [], sending = [], ends_s: ends = {}, time_s: nowS = 0 } = this.operator ?? {};
    const box = byId("faults"), state = (number) => (sending.includes(number) ? " (being sent)"
      : number in ends ? ` (${Math.max(0, ends[number] - nowS).toFixed(1)} s left)` : active.includes(number) ? " (acts)" : "");
    const manual = faults.map((text, at) => [text, at + 1]).filter(([text, at]) => text.includes("@manual")
      && at !== this.emergency && (!CATALOGUED.test(text) || active.includes(at)));
    const key = JSON.stringify([manual, runs, faults.length, active, injected]);
    const told = (what, number) => (what === "clear" ? state(number) : injected.includes(number) ? " (used)" : "");
    for (const one of box.dataset.key === key ? box.children : []) {
      one.querySelector("i").textContent = told(one.dataset.do, Number(one.dataset.fault));
    }
    if (box.dataset.key === key) return;
    box.dataset.key = key;
    byId("prepared").replaceChildren(...prepared.map(([text]) => element("option", { value: shortFault(text), label: CATALOGUED.exec(text)[1] })));
    box.replaceChildren(...manual.flatMap(([text, number]) => (CATALOGUED.test(text) ? ["clear"] : ["inject", "clear"]).map((what) => {
      const short = shortFault(text), button = element("button", { type: "button", "data-do": what, "data-fault": number },
        what === "inject" ? `⚡ ${short}` : `clear ${short}`, element("i", {}, told(what, number)));
      const used = what === "inject" && injected.includes(number);
      button.disabled = !runs || (what === "inject" ? used : !active.includes(number));
      button.title = used ? "a fault is injected once in a run" : "";
      button.addEventListener("click", () => this.order({ do: what, fault: number, ...(what === "inject" ? duration() : {}) }, `${what} ${short}`));
      return button;
    })));
  }
}
