// The page: reads the figures in #data and draws the sections that fit them.

function add_header(kind, title, facts, command) {
  document.title = `${title} – Meristem ${kind}`;
  const main = document.getElementById("report");
  main.replaceChildren(
    element(
      "header",
      {},
      element("div.kind", {}, "Meristem " + kind),
      element("h1", {}, title),
      element("p.muted", {}, facts),
      command ? element("code.command", {}, command) : null,
    ),
  );
  const nav = element("nav", { "aria-label": "sections" });
  main.append(nav);
  return nav;
}

function fill_navigation(nav) {
  for (const s of document.querySelectorAll("section"))
    nav.append(element("a", { href: "#" + s.id }, s.querySelector("h2").textContent));
}

function run_facts(stats) {
  const mode =
    stats.expand === "lazy" ? "expanded lazily" : stats.expand === "eager" ? "expanded eagerly" : "one flat scene";
  return (
    `${stats.image.width} × ${stats.image.height} pixels, ${format_count(stats.samples)} samples, ${stats.threads} ` +
    `${stats.threads === 1 ? "thread" : "threads"}, ${mode}` +
    (stats.profile && stats.profile.budget_bytes ? ` within ${format_bytes(stats.profile.budget_bytes)}` : "") +
    (stats.interrupted ? "; interrupted" : "")
  );
}

const file_name = (path) => path.split("/").pop();

function show_profile(data) {
  const stats = data.stats;
  const nav = add_header("profile", file_name(stats.scene), run_facts(stats), stats.command);
  add_glance(stats);
  add_images(
    data.images,
    "The image and what it cost",
    data.images.length > 1
      ? "Beside the image, what each of its pixels took: black is nothing, the brightest the 99.5th percentile."
      : "",
  );
  add_memory(stats);
  add_work(stats);
  add_time(stats);
  add_cells(stats);
  add_latency(stats);
  add_budget(stats);
  add_bounds(stats);
  add_notes(data, recording_notes);
  fill_navigation(nav);
}

const data = JSON.parse(document.getElementById("data").textContent);
if (data.kind === "profile") show_profile(data);
else show_comparison(data);
redraw_all();
watch_for_changes();
document.documentElement.dataset.ready = "true";
