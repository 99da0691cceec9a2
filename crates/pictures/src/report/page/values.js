// The data of a figure as it draws them: on its axes, which may be logarithmic.

/** Classes for the colour at a place of the palette, which comes again with dashes. */
function colourOf(place) {
  return `colour-${place % 8} dash-${Math.floor(place / 8) % 4}`;
}

/** What the script element of a figure holds, ready to draw. */
function readValues(text) {
  const data = JSON.parse(text);
  const scaled = data.logarithmic
    ? (value) => (value > 0 ? Math.log10(value) : NaN)
    : (value) => value ?? NaN;
  data.unscaled = data.logarithmic ? (value) => 10 ** value : (value) => value;
  for (const panel of data.panels) {
    panel.series.forEach((series) => prepareSeries(series, scaled));
    panel.marks.forEach((mark) => (mark.x = scaled(mark.x)));
    for (const band of panel.bands) {
      // The ends of the axis are written as null.
      band.from = band.from === null ? -Infinity : scaled(band.from);
      band.to = band.to === null ? Infinity : scaled(band.to);
      if (Number.isNaN(band.from)) band.from = -Infinity;
    }
    for (const lane of panel.lanes) {
      lane.stretches = lane.stretches.map(([from, to, of]) => ({ from: scaled(from), to: scaled(to), of }));
    }
    if (panel.cells) panel.cells.rows = panel.cells.rows.map(spread);
    panel.hasY = panel.lanes.length === 0;
  }
  data.full = fullRange(data);
  data.stops = readingStops(data);
  return data;
}

function prepareSeries(series, scaled) {
  series.x = Float64Array.from(series.x, scaled);
  series.y = Float64Array.from(series.y, scaled);
  // A break without a place gets its neighbour's, for what is looked up along x has to have one.
  let before = series.x.find(Number.isFinite) ?? 0;
  series.x.forEach((x, place) => {
    if (!Number.isFinite(x)) [series.x[place], series.y[place]] = [before, NaN];
    before = series.x[place];
  });
  series.key = JSON.stringify([series.label, series.colour, series.style, series.marker]);
  series.isLine = series.style !== "dots";
}

/** Runs of equal cells as a cell each. */
function spread(runs) {
  const row = [];
  for (let i = 0; i < runs.length; i += 2) row.push(...Array(runs[i + 1]).fill(runs[i]));
  return row;
}

/** The whole range of x. It does not depend on what is switched off. */
function fullRange(data) {
  const ranges = data.panels.flatMap((panel) => [
    ...panel.series.map((series) => shownExtent(series, 0)),
    extent(panel.marks.map((mark) => mark.x)),
    panel.raster?.x,
    extent(panel.bands.flatMap(({ from, to }) => [from, to])),
    panel.cells?.x,
    extent(panel.lanes.flatMap((lane) => lane.stretches.flatMap(({ from, to }) => [from, to]))),
  ]);
  const all = extent(ranges.filter(Boolean).flat()) ?? [0, 1];
  const curvesTurn = data.panels.some((panel) => panel.series.some((series) => !series.ascending));
  const hasDots = data.panels.some((panel) =>
    panel.series.some((series) => !series.isLine || series.labels.length),
  );
  const hasEdges = data.panels.some((panel) => panel.raster || panel.cells);
  return roomy(all, data.logarithmic ? 0.05 : (curvesTurn || hasDots) && !hasEdges ? 0.03 : 0);
}

/** The range that a curve spans with points that have both values. */
function shownExtent(series, axis) {
  const [values, others] = axis === 0 ? [series.x, series.y] : [series.y, series.x];
  return extent(values.filter((_, place) => Number.isFinite(others[place])));
}

/** How the figure is read: along x at once in all curves, point by point, or cell by cell. */
function readingOf(data) {
  if (data.panels.some((panel) => panel.cells)) return "cells";
  const lines = data.panels.flatMap((panel) => panel.series.filter((series) => series.isLine));
  return lines.every((series) => series.ascending) ? "along" : "points";
}

/** The places on x where something is known, ascending: points of curves; where there are none, cells and stretches. */
function readingStops(data) {
  const stops = [];
  for (const series of data.panels.flatMap((panel) => panel.series)) {
    series.x.forEach((x, place) => Number.isFinite(x + series.y[place]) && stops.push(x));
  }
  for (const panel of stops.length ? [] : data.panels) {
    for (const lane of panel.lanes) {
      for (const { from, to } of lane.stretches) stops.push(from, (from + to) / 2);
    }
    if (panel.raster) stops.push(...middles(panel.raster.x, panel.raster.columns));
  }
  return Float64Array.from(new Set(stops)).filter(Number.isFinite).sort();
}

function middles([from, to], count) {
  return Array.from({ length: count }, (_, place) => from + ((to - from) * (place + 0.5)) / count);
}

/** The edges of cells of which the first and the last end in their middles, where the axis does. */
function cellEdges([from, to], count) {
  if (count === 1) return [from, to];
  const width = (to - from) / (count - 1);
  return Array.from({ length: count + 1 }, (_, place) => clamp(from + (place - 0.5) * width, from, to));
}

/** The range of y of a panel, from what can be seen of it. */
function rangeOfY(panel, view, isHidden) {
  if (panel.cells) return panel.cells.y;
  const inView = extent(seenValues(panel, view, isHidden));
  const ranges = [
    inView ?? extent(panel.series.flatMap((series) => shownExtent(series, 1) ?? [])),
    panel.zeroLine ? [0, 0] : undefined,
  ];
  if (panel.raster) return extent([...ranges.filter(Boolean).flat(), ...panel.raster.y]);
  return roomy(extent(ranges.filter(Boolean).flat()) ?? [0, 1], 0.06);
}

function* seenValues(panel, view, isHidden) {
  for (const series of panel.series) {
    if (isHidden(series.key)) continue;
    for (let place = 0; place < series.x.length; place++) {
      if (series.x[place] >= view[0] && series.x[place] <= view[1]) yield series.y[place];
    }
    if (!series.isLine || !series.ascending) continue;
    for (const edge of view) yield valueAt(series, edge);
  }
}

/**
 * The value of a curve at x, on the straight line between its points; NaN where it has none. Between the points of a
 * thinned curve there were others, so of such a one it is the value of the nearest point.
 */
function valueAt(series, x) {
  if (series.thinned) return x < series.x[0] || x > series.x.at(-1) ? NaN : series.y[nearest(series.x, x)];
  const next = firstFrom(series.x, x);
  if (series.x[next] === x) return series.y[next];
  if (next === 0 || next === series.x.length) return NaN;
  const part = (x - series.x[next - 1]) / (series.x[next] - series.x[next - 1]);
  return series.y[next - 1] + part * (series.y[next] - series.y[next - 1]);
}
