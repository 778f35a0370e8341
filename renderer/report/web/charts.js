// Plots. Each is drawn by a function that is called again when the window is resized or the theme changes.

const redraws = [];

function add_chart(parent, draw) {
  const place = element("div.chart");
  parent.append(place);
  redraws.push(() => {
    place.replaceChildren();
    draw(place, Math.max(280, place.clientWidth));
  });
}

function redraw_all() {
  for (const redraw of redraws) redraw();
}

function watch_for_changes() {
  let pending = 0;
  let width = document.body.clientWidth;
  window.addEventListener("resize", () => {
    if (document.body.clientWidth === width) return;
    width = document.body.clientWidth;
    clearTimeout(pending);
    pending = setTimeout(redraw_all, 120);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw_all);
}

const axis_font = "12px ui-sans-serif, system-ui, sans-serif";

function axis(label, format, extra) {
  return Object.assign(
    {
      gap: 6,
      stroke: color("muted"),
      font: axis_font,
      labelFont: axis_font,
      label,
      labelSize: 20,
      labelGap: 2,
      grid: { stroke: color("line"), width: 1 },
      ticks: { show: false },
      values: (plot, splits) => splits.map((v) => (v == null ? "" : format(v))),
    },
    extra,
  );
}

// Along the bottom.
function x_axis(label, format, extra) {
  return axis(label, format, Object.assign({ size: 26, labelSize: 22, labelGap: 0 }, extra));
}

// Filled squares, lines as well.
function legend(colors) {
  return { markers: { width: 0, fill: (plot, i) => (i === 0 ? "transparent" : color(colors[i - 1])) } };
}

function with_alpha(hex, alpha) {
  return (
    hex +
    Math.round(alpha * 255)
      .toString(16)
      .padStart(2, "0")
  );
}

// Splits of an axis of bytes at round binary numbers.
function byte_splits(plot, axis_index, low, high) {
  let step = 1;
  while (high / step > 6) step *= 2;
  const result = [];
  for (let v = 0; v <= high; v += step) result.push(v);
  return result;
}

// Areas upon each other: series [{label, color, values}], the first at the bottom. `lines` lie over them unstacked,
// on x values of their own if they have them.
function stacked_chart(
  parent,
  { x, series, lines = [], y_label, format, splits, height = 260, x_label = "seconds since start" },
) {
  add_chart(parent, (place, width) => {
    const sums = [];
    let below = x.map(() => 0);
    for (const s of series) sums.push((below = below.map((v, i) => v + s.values[i])));
    const options = {
      width,
      height,
      cursor: { y: false, points: { show: false } },
      legend: legend([...series.map((s) => s.color).reverse(), ...lines.map((l) => l.color)]),
      scales: { x: { time: false }, y: { range: (plot, low, high) => [0, Math.max(high * 1.06, 1e-9)] } },
      axes: [
        x_axis(x_label, (v) => String(+v.toPrecision(6))),
        axis(y_label, format, Object.assign({ size: 62 }, splits ? { splits } : {})),
      ],
      series: [{ label: "time", value: (plot, v) => (v == null ? "" : format_seconds(v)) }],
      bands: [],
    };
    const data = [x];
    // uPlot draws in order: the highest sum first, each lower one over it
    for (let i = series.length; i-- > 0;) {
      const s = series[i];
      data.push(sums[i]);
      options.series.push({
        label: s.label,
        stroke: color(s.color),
        fill: color(s.color),
        width: 0,
        points: { show: false },
        value: (plot, v, index, at) => (at == null ? "" : format(s.values[at])),
      });
    }
    for (const line of lines) {
      data.push(line.values);
      options.series.push({
        label: line.label,
        stroke: color(line.color),
        width: 1.5,
        dash: line.dash,
        points: { show: false },
        spanGaps: true,
        value: (plot, v) => (v == null ? "" : format(v)),
      });
    }
    new uPlot(options, data, place);
  });
}

// Lines over one x: series [{label, color, values, dash, points}].
function line_chart(
  parent,
  { x, series, x_label, y_label, x_format, y_format, x_log = false, x_splits, y_splits, height = 260, marks = [] },
) {
  add_chart(parent, (place, width) => {
    const marker = {
      hooks: {
        draw: (plot) => {
          const c = plot.ctx;
          for (const mark of marks) {
            const at = plot.valToPos(mark.x, "x", true);
            c.save();
            c.strokeStyle = c.fillStyle = color(mark.color || "muted");
            c.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
            c.lineWidth = devicePixelRatio;
            c.beginPath();
            c.moveTo(at, plot.bbox.top);
            c.lineTo(at, plot.bbox.top + plot.bbox.height);
            c.stroke();
            c.font = 12 * devicePixelRatio + "px ui-sans-serif, system-ui, sans-serif";
            const right = at > plot.bbox.left + plot.bbox.width * 0.75;
            c.textAlign = right ? "right" : "left";
            c.fillText(mark.label, at + (right ? -6 : 6) * devicePixelRatio, plot.bbox.top + 14 * devicePixelRatio);
            c.restore();
          }
        },
      },
    };
    new uPlot(
      {
        width,
        height,
        cursor: { y: false },
        plugins: [marker],
        legend: legend(series.map((s) => s.color)),
        scales: {
          x: { time: false, distr: x_log ? 3 : 1, log: 2 },
          y: { range: (plot, low, high) => [0, Math.max(high * 1.08, 1e-9)] },
        },
        axes: [
          x_axis(x_label, x_format, x_splits ? { splits: x_splits } : {}),
          axis(y_label, y_format, Object.assign({ size: 62 }, y_splits ? { splits: y_splits } : {})),
        ],
        series: [{ label: x_label, value: (plot, v) => (v == null ? "" : x_format(v)) }].concat(
          series.map((s) => ({
            label: s.label,
            stroke: color(s.color),
            width: s.width ?? 1.75,
            dash: s.dash,
            spanGaps: true,
            fill: s.fill ? with_alpha(color(s.color), 0.14) : undefined,
            paths: s.steps ? uPlot.paths.stepped({ align: 1 }) : s.width === 0 ? () => null : undefined,
            points: { show: !!s.points, size: 8, fill: color(s.color) },
            value: (plot, v) => (v == null ? "" : y_format(v)),
          })),
        ),
      },
      [x].concat(series.map((s) => s.values)),
      place,
    );
  });
}

// Bars side by side over bins whose bounds double: values[i] from bounds[i] on.
function histogram(parent, { bounds, values, label, color_name, x_format, y_label, marks = [], height = 230 }) {
  let first = values.findIndex((v) => v > 0),
    last = values.findLastIndex((v) => v > 0);
  first = Math.max(0, first - 1);
  last = Math.min(values.length - 1, last + 1);
  const index = [];
  for (let i = first; i <= last; ++i) index.push(i);
  const position = (value) => {
    let i = first;
    while (i < last && bounds[i + 1] <= value) ++i;
    return i;
  };
  add_chart(parent, (place, width) => {
    const lines = {
      hooks: {
        draw: (plot) => {
          const c = plot.ctx;
          marks.forEach((mark, row) => {
            const at = plot.valToPos(position(mark.x) + 0.5, "x", true);
            c.save();
            c.strokeStyle = c.fillStyle = color("ink");
            c.lineWidth = devicePixelRatio;
            c.beginPath();
            c.moveTo(at, plot.bbox.top + (6 + 16 * row) * devicePixelRatio);
            c.lineTo(at, plot.bbox.top + plot.bbox.height);
            c.stroke();
            c.font = 12 * devicePixelRatio + "px ui-sans-serif, system-ui, sans-serif";
            c.textAlign = "left";
            c.fillText(mark.label, at + 5 * devicePixelRatio, plot.bbox.top + (14 + 16 * row) * devicePixelRatio);
            c.restore();
          });
        },
      },
    };
    new uPlot(
      {
        width,
        height,
        cursor: { y: false },
        plugins: [lines],
        legend: legend([color_name]),
        scales: {
          x: { time: false, range: [first - 0.5, last + 1.5] },
          y: { range: (plot, low, high) => [0, Math.max(high * 1.1, 1)] },
        },
        axes: [
          x_axis("from this long on", (i) => x_format(bounds[i]), {
            splits: () => index.filter((i) => i % 4 === 0),
            grid: { show: false },
          }),
          axis(y_label, format_short_count, { size: 62 }),
        ],
        series: [
          { label: "from", value: (plot, i) => (i == null ? "" : x_format(bounds[i])) },
          {
            label,
            fill: color(color_name),
            stroke: color(color_name),
            width: 0,
            points: { show: false },
            paths: uPlot.paths.bars({ size: [0.9], align: 1 }),
            value: (plot, v) => (v == null ? "" : format_count(v)),
          },
        ],
      },
      [index, index.map((i) => values[i])],
      place,
    );
  });
}

// One row of shares: parts [{color, value, label}].
function share_bar(parts, whole) {
  return element(
    "div.track",
    {},
    parts
      .filter((p) => p.value > 0)
      .map((p) =>
        element("i", {
          style: `width:${(100 * p.value) / whole}%;background:var(--${p.color})`,
          title: `${p.label}: ${format_seconds(p.value)}, ${format_share(p.value / whole)}`,
        }),
      ),
  );
}

function key(entries) {
  return element(
    "div.key",
    {},
    entries.map((e) => element("span", { style: `--c:var(--${e.color})` }, e.label)),
  );
}

// Medians as dots with the range of all runs: rows [{label, values, color}], all on one axis from 0.
function range_rows(rows, format) {
  const most = Math.max(...rows.flatMap((r) => r.values), 1e-12);
  const grid = element("div.ranges");
  for (const row of rows) {
    const values = [...row.values].sort((a, b) => a - b);
    const middle = median(values),
      at = (v) => ((100 * v) / most).toFixed(2) + "%";
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.innerHTML =
      `<line x1="0" x2="100%" y1="10" y2="10" stroke="var(--line)"/>` +
      `<line x1="${at(values[0])}" x2="${at(values[values.length - 1])}" y1="10" y2="10" ` +
      `stroke="var(--${row.color})" stroke-width="3"/>` +
      values.map((v) => `<line x1="${at(v)}" x2="${at(v)}" y1="6" y2="14" stroke="var(--${row.color})"/>`).join("") +
      `<circle cx="${at(middle)}" cy="10" r="5" fill="var(--${row.color})"/>`;
    grid.append(element("span", {}, row.label), svg, element("span.value", {}, format(middle)));
  }
  return grid;
}

function median(sorted) {
  const n = sorted.length;
  return n % 2 ? sorted[(n - 1) / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}
