// Where everything of a chart stands, px. All of it follows from the width there is.

const TICK = 5;
const LANE = 26;
const MOST_MARK_ROWS = 6;

function layoutOf(data, width, view, isHidden) {
  const size = width < 560 ? 12 : 13;
  setTextSize(size);
  const row = size + 5;
  const panels = data.panels.map((panel) => ({ panel, row }));
  const plain = panels.filter(({ panel }) => panel.hasY).length;
  for (const place of panels) {
    place.height = heightOf(place.panel, plain, width);
    place.y = place.panel.hasY ? rangeOfY(place.panel, view, isHidden) : undefined;
    place.ticks = place.panel.hasY ? ticksOfY(data, place.y, place.height) : [];
  }
  const left = Math.ceil(Math.max(30, ...panels.map((place) => widthAtLeft(place, width)))) + TICK + 5;
  const right = width - 16;
  const xTicks = ticksOfX(data, view, right - left);
  let top = 2;
  for (const place of panels) {
    Object.assign(place, { left, right, view });
    top = placeHead(place, top, row);
    top = placeMarks(place, top, row);
    place.top = top;
    place.bottom = top + place.height;
    top = place.bottom + 12;
  }
  const xLabel = wrapped(data.xLabel, right - left);
  const bottom = panels.at(-1).bottom;
  return {
    data,
    width,
    size,
    row,
    panels,
    left,
    right,
    view,
    xTicks,
    xLabel,
    bottom,
    height: bottom + TICK + row * (1 + xLabel.length) + 6,
  };
}

function heightOf(panel, count, width) {
  if (!panel.hasY) return LANE * panel.lanes.length;
  if (panel.cells) return clamp(0.62 * width, 260, 520);
  if (count === 1) return clamp(0.48 * width, 230, 420);
  return count === 2 ? clamp(0.32 * width, 180, 280) : clamp(0.24 * width, 140, 210);
}

function ticksOfY(data, range, height) {
  return (data.logarithmic ? logarithmicTicks : ticks)(range, height / 42);
}

/** As many ticks as have room for their numbers beside each other. */
function ticksOfX(data, view, width) {
  for (let most = Math.floor(width / 55); most > 1; most--) {
    const found = (data.logarithmic ? logarithmicTicks : ticks)(view, most);
    const widest = Math.max(0, ...found.map(({ text }) => textWidth(text)));
    if (found.length * (widest + 14) <= width + widest) return found;
  }
  return (data.logarithmic ? logarithmicTicks : ticks)(view, 1);
}

function widthAtLeft({ panel, ticks: found }, width) {
  if (panel.hasY) return Math.max(...found.map(({ text }) => textWidth(text)), 0);
  const names = panel.lanes.map((lane) => textWidth(lane.name));
  return Math.min(Math.max(...names), 0.34 * width);
}

/** The label of the y axis stands above its panel: turned text is hard to read, and takes width on a phone. */
function placeHead(place, top, row) {
  const { panel } = place;
  const width = place.right;
  place.label = { lines: panel.yLabel ? wrapped(panel.yLabel, width) : [], top };
  top += row * place.label.lines.length;
  if (panel.raster) {
    place.scale = { lines: wrapped(panel.raster.label, width), top };
    top += row * (place.scale.lines.length + 1);
  }
  return top + 7;
}

/**
 * Labels of marks in rows, beside their lines. A line goes down from its label's row, so a label stands above those
 * whose lines it would cross: labels to the right of their lines are placed from the right; those that the end of the
 * frame, or another such label, turns to the left are placed first, from the left.
 */
function placeMarks(place, top, row) {
  const seen = place.panel.marks.filter(({ x }) => x >= place.view[0] && x <= place.view[1]);
  const labelled = seen
    .filter(({ label }) => label)
    .map(({ x, label }) => ({ at: acrossOf(place, x), label }));
  let edge = Infinity;
  const wanted = labelled
    .sort((a, b) => b.at - a.at)
    .map(({ at, label }) => {
      const width = textWidth(label) + 8;
      const ends = (at + width > place.right + 12 || at > edge) && at - width > 0;
      if (ends) edge = Math.min(edge, at - width);
      return { at, label, ends, span: ends ? [at - width, at] : [at, at + width] };
    });
  wanted.sort((a, b) => (a.ends === b.ends ? (a.ends ? a.at - b.at : b.at - a.at) : a.ends ? -1 : 1));
  const placed = [];
  for (const one of wanted) {
    const below = placed.filter(({ span }) => span[0] < one.span[1] + 2 && one.span[0] < span[1] + 2);
    one.row = below.reduce((most, { row }) => Math.max(most, row + 1), 0);
    if (one.row < MOST_MARK_ROWS) placed.push(one);
  }
  const rows = placed.reduce((most, { row }) => Math.max(most, row + 1), 0);
  place.marks = { lines: seen.map(({ x }) => acrossOf(place, x)), labels: placed };
  return top + row * rows;
}

function acrossOf({ view, left, right }, x) {
  return left + ((x - view[0]) / (view[1] - view[0])) * (right - left);
}

function downOf({ y, top, bottom }, value) {
  return bottom + ((value - y[0]) / (y[1] - y[0])) * (top - bottom);
}

/** x at a place across the chart. */
function valueAcross({ view, left, right }, at) {
  return view[0] + ((at - left) / (right - left)) * (view[1] - view[0]);
}

function valueDown({ y, top, bottom }, at) {
  return y[0] + ((at - bottom) / (top - bottom)) * (y[1] - y[0]);
}
