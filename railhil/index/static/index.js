// The page of an index: filters, groups, order, two runs compared, trends. Everything is in the page.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const by = id => document.getElementById(id);
  const make = (name, given = {}, ...inside) => { const one = Object.assign(document.createElement(name), given); one.append(...inside); return one; };
  const count = data.columns.folder.rows.length;
  const value = (name, row) => { const column = data.columns[name] ?? data.scores[name]; return column ? column.values[column.rows[row]] : null; };
  const day = seconds => new Date(1000 * seconds).toISOString().slice(0, 16).replace("T", " ");
  // A date that is only that of a file is no date of a record.
  const when = row => (value("dated_by", row) === "file" ? "~" : "") + day(value("made", row));
  const link = folder => data.links + folder.split("/").map(encodeURIComponent).join("/");
  const text = one => one == null ? "" : Array.isArray(one) ? one.join("; ") : String(one);
  const median = values => { const sorted = [...values].sort((one, other) => one - other), half = sorted.length >> 1;
    return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2; };
  const shown = number => railhilView.shown(number);
  // Outcomes of sentences by row.
  const outcomes = Array.from({length: count}, () => new Map());
  for (const [row, id, verdict, margin, unit, says] of data.requirements) outcomes[row].set(id, {verdict, margin, unit, says});
  const ids = [...new Set(data.requirements.map(one => one[1]))].sort();
  const titles = {made: "made (UTC)", line: "why", is_signed: "signed"}, told = {...titles, line: "verdict because of"};

  // When the reader has looked before; a page of a file may have no memory.
  const memory = {read: () => { try { return Number(localStorage.getItem("railhil.index")); } catch { return 0; } },
                  write: () => { try { localStorage.setItem("railhil.index", data.written); } catch { /* not kept */ } }};
  const before = memory.read();
  memory.write();

  // The word for orders of the served pages; the address bar forgets it, this tab does not.
  if (data.served && location.hash.startsWith("#token=")) {
    sessionStorage.setItem("railhil-token", location.hash.slice(7));
    history.replaceState(null, "", location.pathname);
  }
  const token = data.served ? sessionStorage.getItem("railhil-token") : null;
  const state = {order: "made", down: true, limit: 200, chosen: [], filters: {}, group: "", hash: token ? `#token=${token}` : ""};

  // Filters.
  const keys = ["kind", "verdict", "scenario", "law", "version"];
  const distinct = name => [...new Set(data.columns[name].rows.map(at => text(data.columns[name].values[at])))].sort();
  const select = (name, title, options) => {
    const one = make("select", {id: `by-${name}`});
    one.append(...options.map(([key, said]) => new Option(said, key)));
    by("filters").append(make("label", {}, `${title} `, one));
    one.addEventListener("change", () => { state.limit = 200; show(); });
    return one;
  };
  for (const name of keys)
    state.filters[name] = select(name, name, [["*", "all"], ...distinct(name).map(one => [one, one || "none"])]);
  if (ids.length) state.filters.requirement = select("requirement", "requirement", [["*", "all"], ...ids.flatMap(id => [[`${id}\n`, id],
    ...[...new Set(data.requirements.filter(one => one[1] === id).map(one => one[2]))].map(verdict => [`${id}\n${verdict}`, `${id} ${verdict}`])])]);
  const groupBy = select("group", "group by", [["", "nothing"], ...keys.map(one => [one, one]), ...(ids.length ? [["requirement", "requirement"]] : [])]);
  const since = by("since"), HOUR = 3600;
  since.append(new Option("at any time", ""), ...(before ? [new Option(`since you looked (${day(before)})`, before)] : []),
    ...[[24, "in 24 hours"], [168, "in 7 days"], [720, "in 30 days"]].map(([hours, said]) => new Option(said, data.written - hours * HOUR)),
    new Option("new in this index", "new"));
  for (const one of [since, by("search")]) one.addEventListener("input", () => { state.limit = 200; show(); });
  by("filters").addEventListener("submit", event => event.preventDefault());

  const fresh = new Set(data.new);
  const whole = Array.from({length: count}, (_, row) => [...keys, "folder", "line", "problem", "faults", "seed"].map(name => text(value(name, row))).join("\n").toLowerCase());
  function filtered() {
    const words = by("search").value.toLowerCase().split(/\s+/).filter(Boolean), found = [];
    const wanted = keys.map(name => [name, state.filters[name].value]).filter(one => one[1] !== "*");
    const [id, verdict] = (state.filters.requirement?.value ?? "*").split("\n");
    for (let row = 0; row < count; row++) {
      if (since.value === "new" ? !fresh.has(row) : since.value && value("made", row) < Number(since.value)) continue;
      if (!wanted.every(([name, one]) => text(value(name, row)) === one)) continue;
      if (id !== "*" && !(outcomes[row].has(id) && (!verdict || outcomes[row].get(id).verdict === verdict))) continue;
      if (words.every(word => whole[row].includes(word))) found.push(row);
    }
    return found;
  }

  // Scores of the one system of these rows; of several those that all have.
  function criteria(rows) {
    const systems = [...new Set(rows.filter(row => value("kind", row) === "run").map(row => text(value("system", row))))];
    const lists = systems.map(name => data.systems[name]?.criteria ?? []);
    return (lists[0] ?? []).filter(one => one.brief && one.key in data.scores && lists.every(list => list.some(other => other.key === one.key)));
  }

  function sorted(rows) {
    const name = state.order, side = state.down ? -1 : 1, of = row => value(name, row);
    const isNumber = rows.every(row => of(row) == null || typeof of(row) === "number");
    // Rows without a value come last, in either direction.
    return [...rows].sort((one, other) => {
      const [a, b] = [of(one), of(other)];
      if (a == null || b == null) return (a == null) - (b == null);
      return side * (isNumber ? a - b : text(a).localeCompare(text(b))) || other - one;
    });
  }

  function badge(verdict) { return verdict ? make("span", {className: `badge ${verdict}`, textContent: verdict}) : ""; }

  function heads(names, scores) {
    const head = make("tr");
    const add = (name, title) => {
      const button = make("button", {type: "button", textContent: title}), one = make("th", {scope: "col"}, button);
      if (state.order === name) one.ariaSort = state.down ? "descending" : "ascending";
      button.addEventListener("click", () => { state.down = state.order === name ? !state.down : name === "made"; state.order = name; show(name); });
      button.dataset.order = name;
      head.append(one);
    };
    head.append(make("th", {scope: "col", textContent: "two"}));
    for (const name of names) add(name, titles[name] ?? name);
    for (const one of scores) add(one.key, one.unit ? `${one.title} (${one.unit})` : one.title);
    add("line", titles.line);
    return head;
  }

  function place(row) {
    const folder = value("folder", row), isRun = value("kind", row) === "run", found = [];
    const add = (href, said) => found.push(found.length ? " " : "", make("a", {href, textContent: said}));
    if (data.served && isRun && !value("problem", row)) add(`panel/open?run=${encodeURIComponent(folder)}${state.hash}`, folder);
    else if (!data.served) add(link(folder) + (value("has_report", row) ? "/report.html" : "/"), folder);
    else found.push(folder);
    if (data.served && value("has_report", row)) add(`report?run=${encodeURIComponent(folder)}`, "report");
    return found;
  }

  function line(row, names, scores) {
    const one = make("tr", {className: before && value("made", row) >= before ? "new" : ""});
    const box = make("input", {type: "checkbox", checked: state.chosen.includes(row), ariaLabel: `compare ${value("folder", row)}`});
    const canBe = value("kind", row) === "run" && !value("problem", row);
    box.addEventListener("change", () => {
      state.chosen = box.checked ? [...state.chosen, row].slice(-2) : state.chosen.filter(other => other !== row);
      for (const other of document.querySelectorAll("#rows input")) other.checked = state.chosen.includes(Number(other.value));
      compare();
    });
    box.value = row;
    one.append(make("td", {}, canBe ? box : ""));
    for (const name of names) {
      const cell = make("td", {className: name === "seed" ? "number" : name});
      cell.append(...(name === "folder" ? place(row) : name === "made" ? [when(row)] : name === "verdict" ? [badge(value(name, row))] : [text(value(name, row))]));
      one.append(cell);
    }
    for (const criterion of scores) {
      const number = value(criterion.signed ? `signed_${criterion.key}` : criterion.key, row) ?? value(criterion.key, row);
      one.append(make("td", {className: "number", textContent: number == null ? "" : number.toFixed(criterion.digits)}));
    }
    const faults = text(value("faults", row));
    const said = value("problem", row) || [text(value("line", row)), faults && `faults: ${faults}`].filter(Boolean).join("; ");
    one.append(make("td", {className: value("problem", row) ? "line problem" : "line", textContent: said, title: said}));
    return one;
  }

  function groups(rows) {
    const name = groupBy.value, found = new Map();
    for (const row of rows) {
      const own = name === "requirement" ? [...outcomes[row]].map(([id, one]) => [id, one.verdict]) : [[text(value(name, row)), text(value("verdict", row))]];
      for (const [key, verdict] of own) {
        const one = found.get(key) ?? {rows: 0, verdicts: {}, newest: 0};
        one.rows++; one.newest = Math.max(one.newest, value("made", row));
        if (verdict) one.verdicts[verdict] = (one.verdicts[verdict] ?? 0) + 1;
        found.set(key, one);
      }
    }
    const verdicts = [...new Set([...found.values()].flatMap(one => Object.keys(one.verdicts)))];
    by("rows").tHead.replaceChildren(make("tr", {}, ...[name, "folders", ...verdicts, "newest (UTC)"].map(textContent => make("th", {scope: "col", textContent}))));
    by("rows").tBodies[0].replaceChildren(...[...found].sort().map(([key, one]) => {
      const button = make("button", {type: "button", className: "more", textContent: key || "none"});
      button.addEventListener("click", () => { state.filters[name].value = name === "requirement" ? `${key}\n` : key; groupBy.value = ""; show(); state.filters[name].focus(); });
      const numbers = [one.rows, ...verdicts.map(verdict => one.verdicts[verdict] ?? 0)];
      return make("tr", {}, make("td", {}, button), ...numbers.map(number => make("td", {className: "number", textContent: number})), make("td", {textContent: day(one.newest)}));
    }));
    return found.size;
  }

  const more = document.querySelector("button.more");
  more.addEventListener("click", () => { state.limit += 200; show(); });

  function show(focus) {
    const rows = filtered(), scores = criteria(rows);
    let said = `${rows.length} of ${count} folders`;
    more.hidden = true;
    if (groupBy.value) said += ` in ${groups(rows)} groups`;
    else {
      const names = ["folder", "verdict", "made", ...["kind", "scenario", "law", "version"].filter(name => new Set(rows.map(row => text(value(name, row))).filter(Boolean)).size > 1), "seed"];
      const first = sorted(rows).slice(0, state.limit);
      by("rows").tHead.replaceChildren(heads(names, scores));
      by("rows").tBodies[0].replaceChildren(...first.map(row => line(row, names, scores)));
      more.hidden = first.length === rows.length;
      if (!more.hidden) said += `, ${first.length} shown`;
    }
    by("count").textContent = said + ".";
    if (focus) document.querySelector(`[data-order="${focus}"]`)?.focus();
    offer(rows);
    trend(rows);
  }

  // Two runs.
  const FACTS = Object.keys(data.columns).filter(name => !["folder", "kind", "has_report", "problem", "command"].includes(name));
  let drawn = [];
  function compare() {
    for (const one of drawn) one.destroy();
    drawn = [];
    by("curves").replaceChildren();
    by("compare").hidden = state.chosen.length < 2;
    if (by("compare").hidden) return;
    const [a, b] = state.chosen, table = by("compare").querySelector("table"), body = [];
    const folders = [a, b].map(row => value("folder", row));
    table.tHead.replaceChildren(make("tr", {}, ...["what", ...folders, "difference"].map(textContent => make("th", {scope: "col", textContent}))));
    const add = (title, one, other, difference = "") => body.push(make("tr", {}, make("th", {scope: "row", textContent: title}),
      ...[one, other, difference].map(textContent => make("td", {textContent}))));
    const show = (name, row) => { const one = value(name, row); return name === "made" ? when(row) : typeof one === "number" ? shown(one) : text(one); };
    for (const name of FACTS) {
      if (name === "parameters") continue;
      const [one, other] = [show(name, a), show(name, b)];
      if (one !== other) add(told[name] ?? name.replaceAll("_", " "), one || "none", other || "none");
    }
    const [own, others] = [a, b].map(row => JSON.parse(value("parameters", row) ?? "{}"));
    for (const name of Object.keys({...own, ...others}).sort())
      if (JSON.stringify(own[name]) !== JSON.stringify(others[name]))
        add(`parameter ${name}`, JSON.stringify(own[name]) ?? "the law's own", JSON.stringify(others[name]) ?? "the law's own");
    const same = !body.length || text(value("frames_sha256", a)) === text(value("frames_sha256", b));
    const known = value("system", a) === value("system", b) ? data.systems[value("system", a)]?.criteria ?? [] : [];
    for (const one of known) {
      const key = one.signed && `signed_${one.key}` in data.scores ? `signed_${one.key}` : one.key, [x, y] = [value(key, a), value(key, b)];
      if (x == null && y == null) continue;
      const digits = number => number == null ? "-" : number.toFixed(one.digits);
      add(one.unit ? `${one.title} (${one.unit})` : one.title, digits(x), digits(y), x == null || y == null ? "" : (y < x ? "" : "+") + (y - x).toFixed(one.digits));
    }
    for (const id of [...new Set([...outcomes[a].keys(), ...outcomes[b].keys()])].sort()) {
      const [one, other] = [outcomes[a].get(id), outcomes[b].get(id)], said = of => of ? `${of.verdict}${of.margin == null ? "" : `, ${shown(of.margin)} ${of.unit ?? ""}`}` : "not judged";
      if (said(one) !== said(other)) add(id, said(one), said(other), one?.margin == null || other?.margin == null ? "" : shown(other.margin - one.margin));
    }
    table.tBodies[0].replaceChildren(...body);
    by("both").replaceChildren(`${folders[0]} and ${folders[1]}: ${same ? "the same frames to the byte." : "rows in which they are equal are left out."} `,
      data.served ? make("a", {href: `panel/open?${folders.map(one => `run=${encodeURIComponent(one)}`).join("&")}${state.hash}`, textContent: "Look at both"}) : `Both with all their signals: railhil panel ${folders.map(one => `${data.root}/${one}`).join(" ")}`);
    curvesOf(a, b, folders);
    by("compare").scrollIntoView({block: "nearest"});
  }

  // Signals of a run: those in the page, or those that the server reads.
  async function signalsOf(row) {
    const folder = value("folder", row);
    try {
      if (data.served) data.curves[folder] ??= await (await fetch(`signals?run=${encodeURIComponent(folder)}`)).json();
    } catch { /* the server has ended, or the folder is gone */ }
    return data.curves[folder];
  }
  async function curvesOf(a, b, folders) {
    const own = await Promise.all([a, b].map(signalsOf)), choice = by("signal"), kept = choice.value;
    // Meanwhile others may have been chosen.
    if (state.chosen[0] !== a || state.chosen[1] !== b) return;
    const [one, other] = own.map(found => found?.columns ?? {}), speed = data.systems[value("system", a)]?.speed;
    const names = Object.keys(one).filter(name => one[name][1] === other[name]?.[1] && [one, other].every(of => of[name][3].some(y => y != null)));
    choice.replaceChildren(...names.map(name => new Option(one[name][1] ? `${one[name][0]} (${one[name][1]})` : one[name][0], name)));
    choice.value = [kept, speed, names[0]].find(name => names.includes(name)) ?? "";
    choice.onchange = () => drawTwo(own, choice.value, folders);
    choice.parentElement.hidden = names.length < 2;
    if (names.length) drawTwo(own, choice.value, folders);
    else by("curves").replaceChildren(make("p", {className: "small", textContent: "The page has no signal of both."}));
  }

  function drawTwo(own, name, folders) {
    for (const one of drawn) one.destroy();
    by("curves").replaceChildren();
    const [label, unit] = own[0].columns[name];
    const [times, first, second] = railhilCharts.join(own.map(({time_s, columns: {[name]: [, , factor, y]}}) => [time_s, y.map(one => one == null ? one : one * factor)]));
    const x = {label: "time", unit: "s"}, height = 220, sync = "compared";
    const both = times.map((_, at) => first[at] != null && second[at] != null ? second[at] - first[at] : undefined);
    const kept = times.map((_, at) => at).filter(at => both[at] !== undefined);
    const series = folders.map((label, place) => ({label, unit, dash: place ? [6, 3] : undefined}));
    drawn = [
      railhilCharts.chart(by("curves"), {title: label, unit, x, series, height, sync}, [times, first, second]),
      railhilCharts.chart(by("curves"), {title: `${folders[1]} less ${folders[0]}`, unit, x, height, sync,
        series: [{label: "difference", unit, colour: 3}]}, [kept.map(at => times[at]), kept.map(at => both[at])])];
    by("curves").append(make("p", {className: "small", textContent: `${kept.length} instants that both records have; the records have more.`}));
  }
  by("clear").addEventListener("click", () => { state.chosen = []; show(); compare(); });

  // Trends.
  const quantities = new Map();
  function offer(rows) {
    const kept = by("quantity").value;
    quantities.clear();
    const systems = [...new Set(rows.map(row => text(value("system", row))))].filter(name => data.systems[name]);
    for (const name of systems) for (const one of data.systems[name].criteria)
      if (one.key in data.scores) quantities.set(`${name} ${one.key}`, {title: systems.length > 1 ? `${name}: ${one.title}` : one.title, unit: one.unit,
        of: row => text(value("system", row)) === name ? value(one.key, row) : null});
    for (const id of ids) {
      const unit = data.requirements.find(one => one[1] === id && one[4])?.[4] ?? "";
      if (rows.some(row => outcomes[row].get(id)?.margin != null)) quantities.set(`margin ${id}`, {title: `margin of ${id}`, unit, of: row => outcomes[row].get(id)?.margin ?? null});
    }
    quantities.set("speed", {title: "speed of the bench", unit: "s simulated in 1 s", of: row => value("speed_factor", row)});
    by("quantity").replaceChildren(...[...quantities].map(([key, one]) => new Option(one.title, key)));
    if (quantities.has(kept)) by("quantity").value = kept;
  }
  let trended = null;
  function trend(rows = filtered()) {
    const quantity = quantities.get(by("quantity").value);
    if (trended) trended.destroy();
    trended = null;
    by("trend").replaceChildren(); by("trend").hidden = true;
    const points = rows.filter(row => value("kind", row) === "run").map(row => ({row, y: quantity?.of(row), made: value("made", row)})).filter(one => one.y != null).sort((one, other) => one.made - other.made);
    const versions = [...new Set(points.map(one => text(value("version", one.row))))];
    const laws = [...new Set(points.map(one => text(value("law", one.row))))];
    const named = quantity?.unit ? `${quantity.title} (${quantity.unit})` : quantity?.title ?? "";
    by("said").textContent = points.length ? `${named} of ${points.length} runs of ${versions.length} versions.` : "None of these folders has such a value.";
    by("versions").tHead.replaceChildren(make("tr", {}, ...["version", "law", "runs", "median", "least", "most", "first run (UTC)"].map(textContent => make("th", {scope: "col", textContent}))));
    const cells = [], span = points.length ? points[points.length - 1].made - points[0].made : 0;
    const unit = span > 172800 ? [86400, "days"] : span > 7200 ? [3600, "h"] : [60, "min"];
    const tables = laws.slice(0, 7).map(law => {
      const own = points.filter(one => text(value("law", one.row)) === law), x = [], y = [];
      if (by("over").value === "made") {
        for (const one of own) {
          const at = (one.made - points[0].made) / unit[0];
          // Runs of one second stand beside each other.
          x.push(x.length && at <= x[x.length - 1] ? x[x.length - 1] + 1e-6 : at); y.push(one.y);
        }
      } else versions.forEach((version, place) => {
        const values = own.filter(one => text(value("version", one.row)) === version).map(one => one.y);
        if (values.length) { x.push(place + 1); y.push(median(values)); }
      });
      return [x, y];
    });
    versions.forEach((version, place) => laws.forEach(law => {
      const own = points.filter(one => text(value("version", one.row)) === version && text(value("law", one.row)) === law);
      if (!own.length) return;
      const values = own.map(one => one.y), numbers = [median(values), Math.min(...values), Math.max(...values)];
      cells.push(make("tr", {}, ...[version || "none", law, own.length, ...numbers.map(one => Number(one.toPrecision(5))), day(own[0].made)].map(textContent => make("td", {textContent}))));
    }));
    by("versions").tBodies[0].replaceChildren(...cells);
    if (!tables.some(([x]) => x.length > 1)) return;
    by("trend").hidden = false;
    const x = by("over").value === "made" ? {label: `after ${day(points[0].made)} UTC`, unit: unit[1]} : {label: "version", range: [.75, versions.length + .25]};
    const series = laws.slice(0, 7).map((label, place) => ({label, unit: quantity.unit, colour: place, dash: [undefined, [6, 3], [2, 2], [8, 2, 2, 2]][place % 4]}));
    trended = railhilCharts.chart(by("trend"), {title: by("over").value === "made" ? quantity.title : `${quantity.title}, median of each version`, unit: quantity.unit, x, series, height: 260}, railhilCharts.join(tables));
    if (by("over").value !== "made") {
      trended.plot.axes[0].values = (plot, splits) => splits.map(at => versions[at - 1] ?? "");
      trended.plot.redraw(false, true);
    }
    if (laws.length > 7) by("trend").append(make("p", {className: "small", textContent: `Curves of 7 of ${laws.length} laws; the table has all.`}));
  }
  for (const id of ["quantity", "over"]) by(id).addEventListener("change", () => trend());

  const runs = data.columns.kind.rows.filter(at => data.columns.kind.values[at] === "run").length;
  const since_then = before ? data.columns.made.rows.filter(at => data.columns.made.values[at] >= before).length : 0;
  by("lead").textContent = `${count} folders, ${runs} of them runs, as of ${day(data.written)} UTC.` + (before ? ` ${since_then} made since you looked at ${day(before)} UTC.` : "");
  show();
})();
