(() => {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const columns = new Map(data.columns.map((one) => [one.name, one]));
  const at = (name, row) => {
    const column = columns.get(name);
    if (!column) return null;
    if (column.words) return column.of[row] < 0 ? null : column.words[column.of[row]];
    return column.numbers[row];
  };
  const HIDDEN = ["summary", "path", "sha256", "code", "page", "findings", "warnings", "start"];
  const shown = data.columns.map((c) => c.name).filter((n) => !HIDDEN.includes(n) && !n.endsWith("_std") && !n.startsWith("p_"));
  const LINE = 28;
  const scroll = document.getElementById("scroll"), head = scroll.querySelector("thead"), body = scroll.querySelector("tbody");
  const filter = document.getElementById("filter"), count = document.getElementById("count");
  const state = { rows: [...Array(data.rows).keys()], sort: "", down: false, verdict: "" };
  const lower = Array(data.rows);
  const words = (row) => (lower[row] ??= data.columns.filter((c) => c.words && c.name !== "sha256" && c.name !== "code")
    .map((c) => at(c.name, row) ?? "").join(" ").toLowerCase());

  const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  const number = (value) => (Math.abs(value) >= 1e5 || (value && Math.abs(value) < 1e-3) ? value.toExponential(3) : String(+value.toPrecision(5)));

  const half = (std) => number(Number((1.96 * std).toPrecision(2)));

  // name>3, name<=3, name=word; all else is a word that must stand somewhere in the row.
  const test = (part) => {
    const found = /^(\w+)(>=|<=|>|<|=)(.+)$/.exec(part);
    if (!found || !columns.has(found[1])) { const word = part.toLowerCase(); return (row) => words(row).includes(word); }
    const [, name, sign, right] = found;
    if (columns.get(name).words || sign === "=") {
      const wanted = right.toLowerCase();
      return (row) => String(at(name, row) ?? "").toLowerCase() === wanted;
    }
    const limit = Number(right);
    const compare = { ">": (a) => a > limit, "<": (a) => a < limit, ">=": (a) => a >= limit, "<=": (a) => a <= limit }[sign];
    return (row) => { const value = at(name, row); return value !== null && compare(value); };
  };

  const choose = () => {
    const tests = filter.value.trim().split(/\s+/).filter(Boolean).map(test);
    if (state.verdict) tests.push((row) => (at("verdict", row) ?? "error") === state.verdict);
    state.rows = [];
    for (let row = 0; row < data.rows; row += 1) if (tests.every((one) => one(row))) state.rows.push(row);
    if (state.sort) {
      const column = columns.get(state.sort), sign = state.down ? -1 : 1;
      const value = column.words ? column.of.map((i) => (i < 0 ? null : column.words[i])) : column.numbers;
      state.rows.sort((a, b) => {
        const x = value[a], y = value[b];
        if (x === null || y === null) return (x === null) - (y === null) || a - b;
        return sign * (column.words ? x.localeCompare(y, undefined, { numeric: true }) : x - y) || a - b;
      });
    }
    count.textContent = `${state.rows.length} of ${data.rows}.`;
    scroll.scrollTop = 0;
    heads(); draw(); multiples();
  };

  const heads = () => {
    head.innerHTML = "<tr>" + shown.map((name) => `<th data-name="${name}" class="${columns.get(name).words ? "words" : ""}">${name}${state.sort === name ? (state.down ? " ↓" : " ↑") : ""}</th>`).join("") + "</tr>";
  };
  const cell = (name, row) => {
    const value = at(name, row);
    if (value === null && name === "verdict") return `<td class="words"><span class="pill error">error</span></td>`;
    if (value === null) return `<td class="${columns.get(name).words ? "words" : ""}"></td>`;
    if (name === "verdict") return `<td class="words"><span class="pill ${value}">${value}</span></td>`;
    if (columns.get(name).words) return `<td class="words" title="${escaped(value)}">${escaped(value)}</td>`;
    const std = at(name + "_std", row);
    return `<td>${number(value)}${std ? ` <small>± ${half(std)}</small>` : ""}</td>`;
  };
  // Only the rows that are seen are in the page.
  const draw = () => {
    const first = Math.max(Math.floor(scroll.scrollTop / LINE) - 10, 0);
    const last = Math.min(first + Math.ceil(scroll.clientHeight / LINE) + 20, state.rows.length);
    const spacer = (lines) => `<tr class="spacer"><td colspan="${shown.length}" style="height:${lines * LINE}px"></td></tr>`;
    const lines = state.rows.slice(first, last).map((row) => `<tr data-row="${row}">${shown.map((name) => cell(name, row)).join("")}</tr>`);
    body.innerHTML = spacer(first) + lines.join("") + spacer(state.rows.length - last);
  };

  const value = document.getElementById("value"), grid = document.getElementById("multiples");
  const MOST = 200;
  const multiples = () => {
    const name = value.value;
    if (!columns.has(name)) { grid.textContent = "No record has a value to show."; return; }
    const robots = new Map();
    for (const row of [...state.rows].sort((a, b) => (at("start", a) ?? 0) - (at("start", b) ?? 0) || a - b)) {
      if (at(name, row) === null) continue;
      const robot = at("robot", row) ?? "";
      if (!robots.has(robot)) robots.set(robot, []);
      robots.get(robot).push(row);
    }
    const all = [...robots.values()].flat().map((row) => at(name, row)).sort((a, b) => a - b);
    const low = all[Math.floor(0.01 * all.length)], high = all[Math.ceil(0.99 * all.length) - 1];
    grid.innerHTML = "";
    for (const [robot, rows] of [...robots].sort((a, b) => a[0].localeCompare(b[0], undefined, { numeric: true })).slice(0, MOST)) {
      const figure = document.createElement("figure");
      figure.dataset.robot = robot;
      figure.innerHTML = `<canvas role="img" aria-label="${escaped(name)} of ${escaped(robot)}"></canvas><figcaption>${escaped(robot)} <small>${rows.length}</small></figcaption>`;
      grid.append(figure);
      dots(figure.querySelector("canvas"), rows, name, low, high);
    }
  };
  const dots = (canvas, rows, name, low, high) => {
    const style = getComputedStyle(document.documentElement), ratio = window.devicePixelRatio || 1;
    canvas.width = ratio * (canvas.clientWidth || 220); canvas.height = ratio * (canvas.clientHeight || 110);
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const width = canvas.width / ratio, height = canvas.height / ratio, room = Math.max(high - low, 1e-3 * Math.abs(high), 1e-300);
    const y = (v) => height - 16 - (height - 28) * (v - low) / room;
    const times = rows.map((row) => at("start", row)), dated = times.every((t) => t !== null) && new Set(times).size > 1;
    const x = (i) => 46 + (width - 54) * (dated ? (times[i] - times[0]) / (times.at(-1) - times[0]) : i / Math.max(rows.length - 1, 1));
    pen.fillStyle = style.getPropertyValue("--quiet"); pen.font = "11px system-ui, sans-serif"; pen.textAlign = "right";
    pen.fillText(number(high), 40, y(high) + 4); pen.fillText(number(low), 40, y(low) + 4);
    pen.strokeStyle = style.getPropertyValue("--grid");
    pen.beginPath(); for (const v of [low, high]) { pen.moveTo(46, y(v)); pen.lineTo(width - 4, y(v)); } pen.stroke();
    pen.strokeStyle = pen.fillStyle = style.getPropertyValue("--extended");
    rows.forEach((row, i) => {
      const v = at(name, row), half = 1.96 * (at(name + "_std", row) ?? 0);
      pen.beginPath(); pen.moveTo(x(i), y(v - half)); pen.lineTo(x(i), y(v + half)); pen.stroke();
      pen.beginPath(); pen.arc(x(i), y(v), 2, 0, 7); pen.fill();
    });
  };

  const record = document.getElementById("record");
  const open = (row) => {
    const page = at("page", row);
    if (page) { window.open(page, "_blank"); return; }
    const told = data.columns.filter((c) => !c.name.endsWith("_std") && at(c.name, row) !== null).map((c) => {
      const v = at(c.name, row), std = at(c.name + "_std", row);
      return `<dt>${c.name}</dt><dd>${typeof v === "number" ? number(v) + (std ? ` ± ${half(std)}` : "") : escaped(v)}</dd>`;
    });
    record.innerHTML = `<form method="dialog"><button>Close</button></form><h2>${escaped(at("name", row))} ${escaped(at("joint", row) ?? "")}</h2>` +
      `<p>${escaped(at("error", row) ?? at("summary", row) ?? "")}</p><pre>msd diagnose ${escaped(at("path", row))} --report page.html</pre><dl>${told.join("")}</dl>`;
    if (!record.open) record.showModal();
    history.replaceState(null, "", `#r${row}`);
  };
  record.addEventListener("close", () => history.replaceState(null, "", "#"));

  head.addEventListener("click", (event) => {
    const name = event.target.dataset.name;
    if (!name) return;
    state.down = state.sort === name ? !state.down : false;
    state.sort = name;
    choose();
  });
  body.addEventListener("click", (event) => { const line = event.target.closest("tr[data-row]"); if (line) open(Number(line.dataset.row)); });
  grid.addEventListener("click", (event) => { const one = event.target.closest("figure"); if (one) { filter.value = `robot=${one.dataset.robot}`; choose(); } });
  document.querySelectorAll(".chips button").forEach((one) => one.addEventListener("click", () => {
    state.verdict = state.verdict === one.dataset.verdict ? "" : one.dataset.verdict;
    document.querySelectorAll(".chips button").forEach((b) => b.classList.toggle("chosen", b.dataset.verdict === state.verdict));
    choose();
  }));
  let waiting = 0;
  filter.addEventListener("input", () => { clearTimeout(waiting); waiting = setTimeout(choose, 120); });
  value.addEventListener("change", multiples);
  scroll.addEventListener("scroll", () => requestAnimationFrame(draw));
  choose();
  document.documentElement.dataset.ready = "yes";
  const asked = /^#r(\d+)$/.exec(location.hash);
  if (asked && Number(asked[1]) < data.rows) open(Number(asked[1]));
})();
