// A fault with values of the operator's own: choose a kind, change its values; the text of the fault is made from them.
import { element } from "./gauges.js";

const BARE = /^[+-]?[\d.]+$/;

export class FaultForm {
  // box: a <details>; the kinds are asked for when it is opened. made: called with the text of the fault.
  constructor(box, ask, made) {
    this.select = box.querySelector("select");
    this.values = box.querySelector(".values");
    this.made = made;
    this.kinds = [];
    box.addEventListener("toggle", () => { if (box.open) ask(); });
    this.select.addEventListener("change", () => this.build());
  }

  take(kinds) {
    const before = this.select.value;
    this.kinds = kinds;
    this.select.replaceChildren(element("option", { value: "" }, kinds.length ? "kind of fault" : "none is prepared"),
      ...kinds.map((kind, at) => element("option", { value: String(at) }, title(kind))));
    this.select.value = before;
    if (this.select.value !== before) { this.select.value = ""; this.build(); }
  }

  build() {
    const kind = this.kinds[Number.parseInt(this.select.value, 10)];
    this.inputs = (kind?.parameters ?? []).map((one) => {
      const input = element("input", { type: "text", value: one.value, size: 8, autocomplete: "off", "data-name": one.name });
      input.disabled = one.fixed;
      input.addEventListener("input", () => this.tell(kind));
      return input;
    });
    this.values.replaceChildren(...this.inputs.map((input, at) => {
      const one = kind.parameters[at];
      return element("label", {}, `${one.meaning} `, input, one.range ? ` ${one.range}` : "");
    }));
    if (kind) this.tell(kind);
  }

  tell(kind) {
    const words = [kind.name];
    for (let at = 0; at < this.inputs.length;) {
      const { keyword } = kind.parameters[at], first = at;
      while (at < this.inputs.length && kind.parameters[at].keyword === keyword) at += 1;
      const texts = this.inputs.slice(first, at).map((input, n) => withUnit(input.value.trim(), kind.parameters[first + n].unit));
      const usual = keyword && texts.every((text, n) => text === kind.parameters[first + n].usual);
      if (!usual) words.push(...(keyword ? [keyword] : []), ...texts);
    }
    this.made([...words, kind.tail].filter(Boolean).join(" "));
  }
}

const withUnit = (text, unit) => (BARE.test(text) ? `${text}${unit}` : text);
const title = (kind) => [kind.name, ...kind.parameters.filter((one) => one.fixed).map((one) => one.value), kind.tail].filter(Boolean).join(" ");
