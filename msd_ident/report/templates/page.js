"use strict";
// Draws the figures: their colours are names of CSS variables, looked up anew for light, dark and paper.
(() => {
  const root = document.documentElement;
  const figures = [...document.querySelectorAll("figure.plot")];
  const config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
  const touch = window.matchMedia("(pointer: coarse)").matches;

  const coloured = (value, style) => {
    if (typeof value === "string") {
      const name = /^var\((--[\w-]+)\)$/.exec(value);
      return name ? style.getPropertyValue(name[1]).trim() : value;
    }
    if (Array.isArray(value)) return value.map((item) => coloured(item, style));
    if (value && typeof value === "object") {
      return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, coloured(item, style)]));
    }
    return value;
  };

  const draw = (figure) => {
    const canvas = figure.querySelector(".canvas");
    const told = coloured(JSON.parse(figure.querySelector("script").textContent), getComputedStyle(root));
    const narrow = canvas.clientWidth < 480;
    delete told.layout.width;
    told.layout.autosize = true;
    if (narrow) {
      told.layout.margin = { l: 50, r: 4, t: 52, b: 42 };
      told.layout.font.size = 11;
    }
    // Lower on paper, the main plot less so: sections then end near the ends of pages.
    const lower = told.layout.height > 500 ? 0.82 : 0.67;
    if (root.classList.contains("printing")) told.layout.height = Math.round(lower * told.layout.height);
    if (touch) told.layout.dragmode = false; // a finger scrolls the page; two zoom
    const zoomed = canvas._fullLayout && canvas._fullLayout.xaxis && !canvas._fullLayout.xaxis.autorange;
    if (zoomed) told.layout.xaxis.range = canvas._fullLayout.xaxis.range.slice();
    figure.dataset.drawn = "yes";
    return Plotly.react(canvas, told.data, told.layout, { ...config, scrollZoom: touch, displayModeBar: touch ? false : "hover" });
  };
  const redraw = () => figures.filter((figure) => figure.dataset.drawn).forEach(draw);

  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) {
        seen.unobserve(entry.target);
        draw(entry.target);
      }
    }
  }, { rootMargin: "400px" });
  figures.forEach((figure) => seen.observe(figure));

  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  // Paper is white and narrow whatever the screen is.
  const paper = (on) => {
    root.classList.toggle("printing", on);
    document.querySelectorAll("details").forEach((one) => {
      if (on && !one.open) { one.open = true; one.dataset.was = "closed"; }
      else if (!on && one.dataset.was) { one.open = false; delete one.dataset.was; }
    });
    root.style.width = on ? "785px" : "";
    figures.forEach(draw);
    root.style.width = "";
  };
  window.addEventListener("beforeprint", () => paper(true));
  window.addEventListener("afterprint", () => paper(false));
})();
