(() => {
  "use strict";
  const charts = JSON.parse(document.getElementById("charts").textContent);
  const style = getComputedStyle(document.documentElement);
  const colour = name => style.getPropertyValue(name).trim();
  const short = (v, digits) => {
    if (v == null) return "–";
    const size = Math.abs(v);
    if (size !== 0 && (size < 1e-3 || size >= 1e6)) return v.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
    return String(+v.toPrecision(digits));
  };
  const font = "13px system-ui, sans-serif";
  // As wide as its longest number, so that none is cut.
  const room = (u, values, axis, cycle) => {
    const own = u.axes[axis];
    const longest = (values || []).reduce((a, b) => (b && b.length > a.length ? b : a), "");
    u.ctx.save();
    u.ctx.font = own.font[0];
    const width = u.ctx.measureText(longest).width / devicePixelRatio;
    u.ctx.restore();
    const wanted = Math.ceil(own.ticks.size + own.gap + width + 8);
    // Never less than before, so that the search for room comes to an end.
    return cycle > 1 ? Math.max(own._size, wanted) : wanted;
  };
  const axis = label => ({
    label, font, labelFont: font, labelSize: label ? 22 : 0, labelGap: 0,
    stroke: colour("--ink"),
    grid: { stroke: colour("--rule"), width: 1 },
    ticks: { stroke: colour("--rule"), width: 1, size: 5 },
    // As many digits as tell a tick from the next one.
    values: (u, splits) => {
      const there = splits.filter(v => v != null);
      const most = Math.max(...there.map(Math.abs)), step = Math.abs(there[1] - there[0]);
      const digits = step > 0 ? Math.min(15, Math.max(6, 2 + Math.ceil(Math.log10(most / step)))) : 6;
      return splits.map(v => (v == null ? "" : short(v, digits)));
    },
  });
  const drawn = new Map();
  const draw = figure => {
    const chart = charts[+figure.dataset.chart];
    const place = figure.querySelector(".plot");
    if (drawn.has(figure)) drawn.get(figure).destroy();
    const value = (u, v) => short(v, 5);
    const line = (name, n) => ({ label: name, stroke: colour(`--c${n + 1}`), width: 1.8, value });
    const unit = chart.unit === "-" ? "" : `[${chart.unit}]`;
    const vertical = chart.lines.length === 1 ? `${chart.lines[0]} ${unit}`.trim() : unit;
    const options = {
      width: place.clientWidth, height: 300,
      scales: { x: { time: false } },
      series: [{ label: chart.x, value }, ...chart.lines.map(line)],
      axes: [{ ...axis(chart.x), size: 30 }, { ...axis(vertical), size: room }],
      cursor: { sync: { key: chart.x, setSeries: false }, drag: { x: true, y: false }, focus: { prox: 24 } },
      focus: { alpha: 0.35 },
    };
    drawn.set(figure, new uPlot(options, chart.data, place));
    figure.classList.add("live");
  };
  const figures = [...document.querySelectorAll("figure[data-chart]")];
  for (const figure of figures) {
    const place = document.createElement("div");
    place.className = "plot";
    figure.append(place);
    draw(figure);
  }
  const sizes = new ResizeObserver(entries => {
    for (const { target } of entries) {
      const plot = drawn.get(target.parentElement);
      if (plot && target.clientWidth > 0 && target.clientWidth !== plot.width) plot.setSize({ width: target.clientWidth, height: 300 });
    }
  });
  figures.forEach(figure => sizes.observe(figure.querySelector(".plot")));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => figures.forEach(draw));
  document.querySelectorAll(".hint").forEach(hint => { hint.hidden = false; });
  document.body.dataset.charts = String(figures.length);
})();
