// The page of `meristem compare`: lazy rendering at several budgets against eager and flat.

const mode_colors = { lazy: "green", eager: "amber", flat: "blue" };

const figure_of = (variant, name) => variant.runs.map((r) => r[name]);
const middle_of = (variant, name) => median(figure_of(variant, name).sort((a, b) => a - b));

function difference_text(d) {
  if (!d) return "reference";
  if (d.differing_pixels === 0) return "none: bit for bit";
  return `${format_count(d.differing_pixels)} pixels, RMSE ${d.rms.toPrecision(2)}, FLIP ${d.flip_mean.toPrecision(2)}`;
}

function add_variants(variants) {
  const s = section(
    "variants",
    "Side by side",
    "Each rendering ran in a process of its own, so that its peak memory is its own, and they took turns. " +
      "Figures are medians; " +
      "the first pixel counts from the start of the program.",
  );
  s.append(
    table(variants, [
      { name: "rendering", value: (v) => v.name },
      { name: "first pixel", value: (v) => format_seconds(middle_of(v, "first_pixel_s")) },
      { name: "whole", value: (v) => format_seconds(middle_of(v, "wall_s")) },
      { name: "memory at most", value: (v) => format_bytes(middle_of(v, "peak_rss_bytes")) },
      {
        name: "geometry at most",
        value: (v) => (v.mode === "flat" ? "–" : format_bytes(middle_of(v, "resident_bytes_peak"))),
      },
      { name: "cells", value: (v) => format_count(middle_of(v, "cells")) },
      {
        name: "again",
        value: (v) =>
          v.stats ? format_share(v.stats.profile.reuse.reexpanded / v.stats.expansion.cells_expanded) : "–",
      },
      { name: "image against the first", value: (v) => difference_text(v.difference) },
    ]),
  );
  const runs = Math.max(...variants.map((v) => v.runs.length));
  for (const [name, title, format] of [
    ["first_pixel_s", "First pixel", format_seconds],
    ["wall_s", "Whole render", format_seconds],
    ["peak_rss_bytes", "Memory at most", format_bytes],
  ]) {
    s.append(
      element("h3", {}, `${title}: ${runs > 1 ? `median and range of ${runs} runs` : "one run"}; less is better`),
    );
    s.append(
      range_rows(
        variants.map((v) => ({ label: v.name, values: figure_of(v, name), color: mode_colors[v.mode] })),
        format,
      ),
    );
  }
}

function add_budgets(variants) {
  const lazy = variants
    .filter((v) => v.stats && v.stats.profile.budget_bytes)
    .sort((a, b) => a.budget_bytes - b.budget_bytes);
  if (lazy.length < 2) return;
  const s = section(
    "budgets",
    "Repeated expansions against the budget",
    "Dots are measured, one render each. The line is what the profile of the smallest budget foretold for the " +
      "larger ones, without rendering them: " +
      "how close it comes to the dots tells how far the advice in a single profile can be trusted. A render that " +
      "expands nothing again stands at what it holds.",
  );
  const curve = reuse_curve(lazy[0].stats.profile);
  const place_of = ({ profile, expansion }) =>
    profile.reuse.reexpanded
      ? profile.budget_bytes
      : Math.min(profile.budget_bytes, expansion.resident_bytes_peak);
  const measured = new Map(lazy.map((v) => [place_of(v.stats), v.stats.profile.reuse.reexpanded]));
  const x = [...new Set([...curve.x, ...measured.keys()])].sort((a, b) => a - b);
  const foretold = (at) => {
    let y = curve.y[0];
    curve.x.forEach((b, i) => {
      if (b <= at) y = curve.y[i];
    });
    return y;
  };
  line_chart(s, {
    x,
    x_log: true,
    x_label: "budget",
    y_label: "expanded again",
    x_format: format_bytes,
    y_format: format_short_count,
    x_splits: binary_splits,
    series: [
      { label: "foretold", color: "muted", values: x.map(foretold), steps: true, dash: [4, 3] },
      { label: "measured", color: "red", values: x.map((v) => measured.get(v) ?? null), points: true, width: 0 },
    ],
  });
}

function add_memory_of_variants(variants) {
  const recorded = variants.filter((v) => v.stats && v.stats.profile);
  if (!recorded.length) return;
  const s = section(
    "memory",
    "Memory over time",
    "Expanded geometry, evicted but unfreed cells included, on one scale. Eager rendering expands everything " +
      "before the first pixel.",
  );
  const most = Math.max(...recorded.map((v) => middle_of(v, "wall_s")));
  const x = Array.from({ length: 400 }, (_, i) => (most * (i + 0.5)) / 400);
  const names = ["green", "violet", "red", "blue-soft", "grey"];
  let next = 0;
  line_chart(s, {
    x,
    x_label: "seconds since start",
    y_label: "memory",
    x_format: (v) => String(+v.toPrecision(5)),
    y_format: format_bytes,
    y_splits: byte_splits,
    height: 300,
    series: recorded.map((v) => {
      const p = v.stats.profile,
        t = p.timeline;
      const total = t.expanded.map(
        (_, i) =>
          t.surfaces_bytes[i] + t.surface_trees_bytes[i] + t.meshes_bytes[i] + t.box_trees_bytes[i] + t.limbo_bytes[i],
      );
      return {
        label: v.name,
        color: v.mode === "lazy" ? names[next++ % names.length] : mode_colors[v.mode],
        values: x.map((at) => total[Math.floor((at - p.start_s) / t.bin_s)] ?? (at < p.start_s ? 0 : null)),
      };
    }),
  });
}

function show_comparison(data) {
  const variants = data.variants.filter((v) => v.runs.length);
  const nav = add_header("comparison", file_name(data.scene), data.facts, data.command);
  const s = section("words", "In words");
  s.append(hint_list(data.hints));
  for (const v of data.variants.filter((v) => !v.runs.length))
    s.append(element("p", {}, `${v.name} gave no image: exit code ${v.exit_code}.`));
  if (variants.length) add_variants(variants);
  add_budgets(variants);
  add_memory_of_variants(variants);
  add_images(
    data.images,
    "The images and how they differ",
    "FLIP is how different two images look when one is flipped to the other: 0 the same, 1 as different as " +
      "colours can be.",
  );
  add_notes(data, [
    "Timed renderings record nothing. The figures of expansion come from one more rendering of each kind, which " +
      "is not timed.",
    ...recording_notes,
  ]);
  fill_navigation(nav);
}
