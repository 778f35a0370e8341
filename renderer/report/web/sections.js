// The sections that a profile is made of. Each takes the figures of one render as `meristem render --profile --stats`
// writes them.

const memory_kinds = [
  { key: "surfaces_bytes", label: "surfaces: vertices", color: "blue" },
  { key: "surface_trees_bytes", label: "surfaces: hierarchies", color: "blue-soft" },
  { key: "meshes_bytes", label: "split cells: meshes", color: "amber" },
  { key: "box_trees_bytes", label: "split cells: bounds", color: "amber-soft" },
  { key: "limbo_bytes", label: "evicted, still in use", color: "red" },
  { key: "plans_bytes", label: "shared plans", color: "grey" },
];
const phases = [
  { key: "expand", label: "expand", color: "green" },
  { key: "build", label: "build hierarchies", color: "violet" },
  { key: "trace", label: "trace", color: "blue" },
  { key: "shade", label: "shade and the rest", color: "amber" },
  { key: "wait", label: "wait for cells", color: "red" },
];

function section(id, title, explanation) {
  const s = element("section", { id }, element("h2", {}, title));
  if (explanation) s.append(element("p.explain", {}, explanation));
  document.getElementById("report").append(s);
  return s;
}

function figure_list(entries) {
  return element(
    "dl.figures",
    {},
    entries.map(([name, value, note, id]) =>
      element(
        "div",
        {},
        element("dt", {}, name),
        element("dd", id ? { id } : {}, value, note ? element("small", {}, note) : null),
      ),
    ),
  );
}

function hint_list(hints) {
  return element(
    "ul.hints",
    {},
    hints.map((h) => element(h.advice ? "li.advice" : "li", {}, h.text)),
  );
}

function bin_times(profile) {
  const width = profile.timeline.bin_s;
  return profile.timeline.expanded.map((_, i) => profile.start_s + (i + 0.5) * width);
}

// columns: [{name, value(row) -> text, bar(row) -> number}]
function table(rows, columns, total) {
  const most = columns.map((c) => (c.bar ? Math.max(...rows.map(c.bar), 1e-12) : 0));
  const cell = (row, c, i) =>
    c.bar
      ? element(
          "td.bar",
          {},
          element("i", {
            style: `width:${((100 * c.bar(row)) / most[i]).toFixed(1)}%${c.color ? `;background:var(--${c.color})` : ""}`,
          }),
        )
      : element("td", {}, c.value(row));
  return element(
    "div.scroll",
    {},
    element(
      "table",
      {},
      element(
        "thead",
        {},
        element(
          "tr",
          {},
          columns.map((c) => element("th", c.title ? { title: c.title } : {}, c.name)),
        ),
      ),
      element(
        "tbody",
        {},
        rows.map((row) =>
          element(
            "tr",
            {},
            columns.map((c, i) => cell(row, c, i)),
          ),
        ),
        total
          ? element(
              "tr.total",
              {},
              columns.map((c) => element("td", {}, c.bar ? "" : c.value(total))),
            )
          : null,
      ),
    ),
  );
}

function add_glance(stats) {
  const p = stats.profile,
    e = stats.expansion,
    again = p.reuse.reexpanded;
  const s = section("glance", "At a glance");
  s.append(
    figure_list([
      ["first pixel", format_seconds(stats.first_pixel_s), "since program start", "figure-first-pixel"],
      ["whole render", format_seconds(stats.wall_s), format_short_count(stats.rays_per_s) + " rays/s", "figure-wall"],
      ["memory at most", format_bytes(stats.peak_rss_bytes), "whole process", "figure-peak"],
      [
        "geometry at most",
        format_bytes(e.resident_bytes_peak),
        p.budget_bytes ? "budget " + format_bytes(p.budget_bytes) : "no budget",
        "figure-resident",
      ],
      [
        "cells expanded",
        format_count(e.cells_expanded),
        format_short_count(e.faces) + " faces made",
        "figure-expanded",
      ],
      [
        "of these again",
        format_share(again / Math.max(1, e.cells_expanded)),
        format_count(again) + " after eviction",
        "figure-again",
      ],
    ]),
  );
  s.append(element("h3", {}, "In words"), hint_list(stats.hints));
}

function add_images(images, title, explanation) {
  if (!images.length) return;
  const s = section("images", title, explanation);
  s.append(
    element(
      images.length === 1 ? "div.images.single" : "div.images",
      {},
      images.map((i) =>
        element(
          "figure",
          {},
          element("img", { src: i.src, alt: i.title, loading: "lazy" }),
          i.low == null
            ? null
            : [
                element("span.scale"),
                element("span.ends.muted", {}, element("span", {}, i.low), element("span", {}, i.high)),
              ],
          element("figcaption", {}, element("b", {}, i.title), " " + i.note),
        ),
      ),
    ),
  );
}

function add_memory(stats) {
  const p = stats.profile,
    t = p.timeline,
    x = bin_times(p);
  const s = section(
    "memory",
    "Memory over time",
    "What expanded geometry holds, by kind, stacked. The budget limits the two blue and the two amber kinds " +
      "together; " +
      "evicted cells are freed once no ray can still be in them, and plans are shared by all cells of one shape. " +
      "The line is the resident memory of the whole process.",
  );
  const process = x.map((at) => {
    const i = p.process.age_s.findIndex((age) => age >= at);
    return i < 0 ? null : p.process.resident_bytes[i];
  });
  const lines = [{ label: "whole process", color: "ink", values: process }];
  if (p.budget_bytes && p.budget_bytes < 4 * stats.expansion.resident_bytes_peak)
    lines.push({ label: "budget", color: "ink", dash: [5, 4], values: x.map(() => p.budget_bytes) });
  stacked_chart(s, {
    x,
    lines,
    y_label: "memory",
    format: format_bytes,
    splits: byte_splits,
    height: 300,
    series: memory_kinds.map((k) => ({ ...k, values: t[k.key] })),
  });
}

function add_work(stats) {
  const p = stats.profile,
    t = p.timeline,
    per_second = (list) => list.map((v) => v / t.bin_s);
  const s = section(
    "work",
    "Expansion over time",
    "How many cells a second were expanded for the first time and again after eviction. First expansions thin " +
      "out once " +
      "the visible geometry stands; a steady stream of repeated ones means that the budget is smaller than what " +
      "the rays keep asking for.",
  );
  stacked_chart(s, {
    x: bin_times(p),
    y_label: "cells a second",
    format: format_short_count,
    height: 230,
    series: [
      { label: "again", color: "red", values: per_second(t.reexpanded) },
      { label: "first time", color: "green", values: per_second(t.expanded.map((v, i) => v - t.reexpanded[i])) },
    ],
    lines: [{ label: "evicted", color: "ink", dash: [3, 3], values: per_second(t.evicted) }],
  });
}

// What each rendering thread did; the rest of its time is shading.
function thread_phases(stats) {
  const lazy = stats.expand === "lazy";
  return stats.profile.threads
    .filter((t) => t.rays > 0)
    .map((t) => {
      const busy = lazy ? t.expand_s + t.build_s + t.wait_s : 0;
      const trace = Math.min(t.trace_s, Math.max(0, stats.render_s - busy));
      return {
        expand: lazy ? t.expand_s : 0,
        build: lazy ? t.build_s : 0,
        wait: lazy ? t.wait_s : 0,
        trace,
        shade: Math.max(0, stats.render_s - busy - trace),
      };
    });
}

function add_time(stats) {
  const p = stats.profile,
    t = p.timeline;
  const s = section(
    "time",
    "Where the time went",
    `Loading took ${format_seconds(stats.load_s)}, rendering ${format_seconds(stats.render_s)} on ` +
      `${stats.threads} threads. ` +
      `Tracing is estimated from one ray in ${p.ray_stride}; shading is what is left.`,
  );
  s.append(key(phases));
  const stack = element("div.stack"),
    whole = sum(phases.map((f) => p.phases_s[f.key]));
  const add = (name, times) => {
    const total = sum(phases.map((f) => times[f.key]));
    stack.append(
      element("span", {}, name),
      share_bar(
        phases.map((f) => ({ ...f, value: times[f.key] })),
        total || 1,
      ),
      element("span.total", {}, format_seconds(total)),
    );
  };
  add("all threads", p.phases_s);
  if (stats.threads <= 16) thread_phases(stats).forEach((times, i) => add("thread " + i, times));
  s.append(stack);
  s.append(
    table(
      phases.map((f) => ({ ...f, seconds: p.phases_s[f.key] })),
      [
        { name: "phase", value: (r) => r.label },
        { name: "thread time", value: (r) => format_seconds(r.seconds) },
        { name: "share", value: (r) => format_share(r.seconds / whole) },
        { name: "", bar: (r) => r.seconds },
      ],
    ),
  );
  s.append(element("h3", {}, "Threads at expansion"));
  const busy = (list) => list.map((v) => v / t.bin_s);
  stacked_chart(s, {
    x: bin_times(p),
    y_label: "threads",
    format: (v) => String(+v.toPrecision(3)),
    height: 200,
    series: [
      { ...phases[0], values: busy(t.expand_s) },
      { ...phases[1], values: busy(t.build_s) },
      { ...phases[4], values: busy(t.wait_s) },
    ],
  });
}

const additive = ["expanded", "reexpanded", "evicted", "hits", "faces", "bytes", "expand_s", "build_s", "boxes"];

// Classes of cells summed by what `name` makes of them.
function grouped(classes, name) {
  classes = classes.filter((c) => c.expanded > 0);
  const groups = new Map();
  for (const c of classes) {
    const label = name(c);
    if (!groups.has(label))
      groups.set(
        label,
        Object.assign(
          { label, box_ratio_sum: 0, box_ratio_max: 0, level: c.level },
          Object.fromEntries(additive.map((k) => [k, 0])),
        ),
      );
    const g = groups.get(label);
    for (const k of additive) g[k] += c[k];
    g.box_ratio_sum += c.box_ratio_mean * c.boxes;
    g.box_ratio_max = Math.max(g.box_ratio_max, c.box_ratio_max);
  }
  return [...groups.values()];
}

function cell_table(first, rows) {
  const total = Object.fromEntries(additive.map((k) => [k, sum(rows.map((r) => r[k]))]));
  return table(
    rows,
    [
      { name: first, value: (r) => r.label || "all" },
      { name: "expanded", value: (r) => format_count(r.expanded) },
      { name: "again", value: (r) => format_count(r.reexpanded) },
      { name: "evicted", value: (r) => format_count(r.evicted) },
      {
        name: "hits",
        title: "visits of rays that found the cell there; estimated",
        value: (r) => format_short_count(r.hits),
      },
      { name: "faces", value: (r) => format_short_count(r.faces) },
      { name: "made", value: (r) => format_bytes(r.bytes) },
      { name: "time", value: (r) => format_seconds(r.expand_s + r.build_s) },
      { name: "", bar: (r) => r.expand_s + r.build_s },
    ],
    total,
  );
}

const rule_name = (c) => `${c.model}: ${c.rule || "no symbol"}`;

function add_cells(stats) {
  const p = stats.profile;
  const s = section(
    "cells",
    "Which cells",
    `Every expansion is a miss: a ray met a cell that was not there. A hit is a visit that found it, estimated ` +
      `from one ray in ${p.ray_stride}.`,
  );
  s.append(element("h3", {}, "By production: the symbol that the first face of a cell carries, for which its rule waits"));
  s.append(
    cell_table(
      "model: rule",
      grouped(p.classes, rule_name).sort((a, b) => b.expand_s - a.expand_s),
    ),
  );
  s.append(element("h3", {}, "By level: steps done before the cell is expanded"));
  s.append(
    cell_table(
      "model, level",
      grouped(p.classes, (c) => `${c.model}, level ${c.level}, ${c.final ? "becomes surface" : "is split"}`).sort(
        (a, b) => a.label.localeCompare(b.label, "en", { numeric: true }),
      ),
    ),
  );
  s.append(element("h3", {}, "By step: what ran inside the expansions"));
  const steps = stats.expansion.by_step;
  s.append(
    table(steps, [
      { name: "model, step", value: (r) => `${r.model}, ${r.step}` },
      { name: "cells", value: (r) => format_count(r.cells) },
      { name: "faces made", value: (r) => format_count(r.faces) },
      { name: "time", value: (r) => format_seconds(r.time_s) },
      { name: "a face", value: (r) => (r.faces ? format_seconds(r.time_s / r.faces) : "–") },
      { name: "", bar: (r) => r.time_s },
    ]),
  );
}

function add_latency(stats) {
  const p = stats.profile,
    l = p.latency;
  if (!l.total) return;
  const s = section(
    "latency",
    "How long one expansion takes",
    "A ray that meets an empty cell is held up for this long, hierarchies included. A long tail means that some " +
      "cells are much larger than others.",
  );
  histogram(s, {
    bounds: l.lower_bounds_s,
    values: l.counts,
    label: "expansions",
    color_name: "green",
    x_format: format_seconds,
    y_label: "expansions",
    marks: [
      { x: l.p50_s, label: "median" },
      { x: l.p99_s, label: "99 %" },
    ],
  });
  if (!p.waits.total) return;
  s.append(element("h3", {}, `Waits for a cell that another thread was expanding: ${format_count(p.waits.total)}`));
  histogram(s, {
    bounds: p.waits.lower_bounds_s,
    values: p.waits.counts,
    label: "waits",
    color_name: "red",
    x_format: format_seconds,
    y_label: "waits",
    height: 170,
  });
}

// Counts of repeated expansions over budgets, from the given budget on.
function reuse_curve(p) {
  const steps = p.reuse.by_budget.filter((s) => s.budget_bytes > p.budget_bytes);
  return {
    x: [p.budget_bytes, ...steps.map((s) => s.budget_bytes)],
    y: [p.reuse.reexpanded, ...steps.map((s) => s.reexpanded)],
  };
}

function binary_splits(plot, axis_index, low, high) {
  const result = [];
  for (let v = 2 ** Math.floor(Math.log2(low)); v <= high * 1.001; v *= 2) if (v >= low * 0.999) result.push(v);
  return result;
}

function add_budget(stats) {
  const p = stats.profile;
  if (!p.budget_bytes || !p.reuse.reexpanded || !p.reuse.by_budget.length) return;
  const s = section(
    "budget",
    "What a larger budget would do",
    "Repeated expansions that would be left, were the budget larger: an estimate from how much other geometry " +
      "came in between " +
      "the eviction of a cell and its return. It errs towards larger budgets. All cells that were expanded take " +
      format_bytes(p.reuse.distinct_bytes) +
      " together.",
  );
  const curve = reuse_curve(p);
  line_chart(s, {
    x: curve.x,
    x_log: true,
    x_label: "budget",
    y_label: "expanded again",
    x_format: format_bytes,
    y_format: format_short_count,
    x_splits: binary_splits,
    series: [{ label: "expanded again", color: "red", values: curve.y, fill: true, steps: true }],
    marks: [{ x: p.budget_bytes, label: "this render: " + format_bytes(p.budget_bytes) }],
  });
}

function add_bounds(stats) {
  const rules = grouped(stats.profile.classes, rule_name).filter((r) => r.boxes > 0);
  if (!rules.length) return;
  for (const r of rules) r.ratio = r.box_ratio_sum / r.boxes;
  const s = section(
    "bounds",
    "How tight bounds are",
    "Before a cell is expanded rays see its conservative box; afterwards the real one. The ratio of their " +
      "surface areas is the " +
      "number of rays that enter the box for each one that would enter the real one: 1 is perfect, and what " +
      "lies above costs needless expansions.",
  );
  s.append(
    table(
      rules.sort((a, b) => b.ratio - a.ratio),
      [
        { name: "model: rule", value: (r) => r.label },
        { name: "boxes", value: (r) => format_count(r.boxes) },
        { name: "mean ratio", value: (r) => format_ratio(r.ratio) },
        { name: "largest", value: (r) => format_ratio(r.box_ratio_max) },
        { name: "", bar: (r) => r.ratio, color: "amber" },
      ],
    ),
  );
}

function add_notes(data, text) {
  const s = section("method", "How this was measured");
  s.append(
    element(
      "div.notes",
      {},
      text.map((t) => element("p", {}, t)),
    ),
  );
  const save = element("button", { type: "button" }, "Save the figures as JSON");
  save.addEventListener("click", () => {
    const link = element("a", {
      download: "meristem-report.json",
      href: URL.createObjectURL(new Blob([JSON.stringify(data, null, 1)], { type: "application/json" })),
    });
    link.click();
    URL.revokeObjectURL(link.href);
  });
  s.append(save);
}

const recording_notes = [
  "Recorded are expansions, evictions, waits, and one ray in 64; that a cell was found is never recorded one by one. " +
    "Times over threads add up, so they may exceed the time that passed.",
  "The time line has at most 1024 bins; when they are full, neighbours are merged. Memory in a bin is that of " +
    "the moment when it was largest. " +
    "Reuse is followed for a sample of at most 65,536 cells, chosen by a hash of their names.",
  "Bytes of geometry are those that the cache counts, what Embree allocates included; 1 MiB is 1,048,576 bytes.",
];
