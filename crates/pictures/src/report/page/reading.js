// What a chart says at its crosshair: lines of values for each panel, for eyes and for screen readers.

/** The lines of a panel at x: [{ name, value, colour }]. */
function linesAlong(place, x, { data, isHidden, y }) {
  const { panel } = place;
  const lines = [];
  for (const series of panel.series) {
    if (isHidden(series.key)) continue;
    const value = series.isLine ? valueAt(series, x) : dotsAt(place, series, x);
    if (!Number.isFinite(value)) continue;
    const text = number(data.unscaled(value));
    const point = series.labels.length ? series.labels[nearest(series.x, x)] : "";
    lines.push({
      name: series.label ?? panel.yLabel,
      value: point ? `${text} (${point})` : text,
      colour: series.colour,
      series,
      at: value,
    });
  }
  if (panel.raster) lines.push(...rasterLines(panel, x, y));
  for (const lane of panel.lanes) {
    const stretch = lane.stretches.find(({ from, to }) => x >= from && x <= to);
    if (!stretch) continue;
    const { name, colour, stripes } = panel.classes[stretch.of];
    lines.push({ name: lane.name, value: name, colour, stripes });
  }
  for (const band of panel.bands) {
    if (band.label && x >= band.from && x <= band.to)
      lines.push({ name: band.label, value: "", colour: band.colour });
  }
  return lines;
}

/** Of dots the one that is nearest to x, if it is that near that the crosshair is on it. */
function dotsAt(place, series, x) {
  let [best, found] = [4, NaN];
  for (let i = 0; i < series.x.length; i++) {
    const away = Math.abs(acrossOf(place, series.x[i]) - acrossOf(place, x));
    if (away < best && Number.isFinite(series.y[i])) [best, found] = [away, series.y[i]];
  }
  return found;
}

/** The value at a place of a raster; where only x is known, the largest value there. */
function rasterLines(panel, x, y) {
  const { raster } = panel;
  const column = Math.floor(((x - raster.x[0]) / (raster.x[1] - raster.x[0])) * raster.columns);
  if (column < 0 || column > raster.columns) return [];
  const rows = middles(raster.y, raster.rows.length);
  const level = (row) => levelAt(raster, row, Math.min(column, raster.columns - 1));
  const known = (row) => (level(row) === 255 ? -1 : level(row));
  const row =
    y === undefined
      ? rows.reduce((most, _, row) => (known(row) > known(most) ? row : most), 0)
      : nearest(rows, y);
  const value = raster.range[0] + (level(row) / 254) * (raster.range[1] - raster.range[0]);
  return [
    { name: y === undefined ? `${panel.yLabel} of the largest` : panel.yLabel, value: number(rows[row], 4) },
    { name: raster.label, value: level(row) === 255 ? "none" : number(value, 3) },
  ];
}

/** The lines of one point of a curve. */
function linesOfPoint(data, panel, series, place) {
  const [x, y] = [series.x[place], series.y[place]].map(data.unscaled);
  const lines = [
    { name: data.xLabel, value: number(x) },
    { name: panel.yLabel, value: number(y) },
  ];
  if (series.label) lines.unshift({ name: series.label, value: "", colour: series.colour });
  if (series.labels[place]) lines.push({ name: series.labels[place], value: "" });
  return lines;
}

/** The lines of one cell of a map. */
function linesOfCell(data, panel, column, row) {
  const { cells, classes } = panel;
  const middle = ([from, to], count, place) =>
    count === 1 ? (from + to) / 2 : from + ((to - from) * place) / (count - 1);
  const { name, colour, stripes } = classes[cells.rows[row][column]];
  return [
    { name: data.xLabel, value: number(middle(cells.x, cells.columns, column), 4) },
    { name: panel.yLabel, value: number(middle(cells.y, cells.rows.length, row), 4) },
    { name, value: "", colour, stripes },
  ];
}

function spoken(lines) {
  return lines.map(({ name, value }) => (value ? `${name}: ${value}` : name)).join("; ");
}
