// Figures for people, always with their unit; and small makers of elements.

const bytes_units = ["B", "KiB", "MiB", "GiB", "TiB"];

function format_bytes(n) {
  let unit = 0;
  while (Math.abs(n) >= 1024 && unit < bytes_units.length - 1) ((n /= 1024), ++unit);
  return (unit === 0 ? String(Math.round(n)) : n.toFixed(n < 99.95 ? 1 : 0)) + " " + bytes_units[unit];
}

function format_count(n) {
  return Math.round(n).toLocaleString("en-US");
}

function format_short_count(n) {
  if (Math.abs(n) >= 1e9) return +(n / 1e9).toPrecision(3) + " G";
  if (Math.abs(n) >= 1e6) return +(n / 1e6).toPrecision(3) + " M";
  if (Math.abs(n) >= 1e4) return +(n / 1e3).toPrecision(3) + " k";
  return String(+n.toPrecision(3));
}

function format_seconds(s) {
  if (s == null) return "never";
  if (s === 0) return "0 s";
  if (s < 1e-3) return +(s * 1e6).toPrecision(3) + " µs";
  if (s < 1) return +(s * 1e3).toPrecision(3) + " ms";
  return s < 100 ? s.toFixed(2) + " s" : s.toFixed(0) + " s";
}

function format_share(x) {
  if (!isFinite(x)) return "–";
  return (x * 100).toFixed(x < 0.0995 && x > 0 ? 1 : 0) + " %";
}

function format_ratio(x) {
  return x > 0 ? (x < 9.95 ? x.toFixed(1) : x.toFixed(0)) + " ×" : "–";
}

// element("td.bar", {title: "x"}, child, "text", ...)
function element(name, attributes, ...children) {
  const [tag, ...classes] = name.split(".");
  const e = document.createElement(tag);
  if (classes.length) e.className = classes.join(" ");
  for (const [key, value] of Object.entries(attributes || {})) e.setAttribute(key, value);
  for (const child of children.flat()) if (child != null) e.append(child);
  return e;
}

function color(name) {
  return getComputedStyle(document.documentElement)
    .getPropertyValue("--" + name)
    .trim();
}

const sum = (list) => list.reduce((a, b) => a + b, 0);
