// The drawing of a chart, from its layout: an SVG whose colours are the style sheet's, so that a change of scheme
// needs no new drawing.

let clips = 0;

function paint(layout, isHidden) {
  const { width, height } = layout;
  const drawing = shape("svg", {
    viewBox: `0 0 ${width} ${pixel(height)}`,
    width,
    height: pixel(height),
    "aria-hidden": "true",
  });
  drawing.style.fontSize = `${layout.size}px`;
  layout.panels.forEach((place) => drawing.append(...paintPanel(layout, place, isHidden)));
  drawing.append(...paintXAxis(layout));
  return drawing;
}

function paintPanel(layout, place, isHidden) {
  const id = `clip-${clips++}`;
  const box = [place.left, place.top, place.right, place.bottom];
  const clip = shape("clipPath", { id }, rectangle(...box));
  const inside = shape(
    "g",
    { "clip-path": `url(#${id})` },
    ...paintRaster(place),
    ...paintBands(place, isHidden),
    ...paintCells(place, isHidden),
    ...paintGrid(layout, place),
    ...paintLanes(place, isHidden),
    ...(place.panel.zeroLine
      ? [line(place.left, downOf(place, 0), place.right, downOf(place, 0), "zero")]
      : []),
    ...place.marks.lines.map((at) => line(at, place.top, at, place.bottom, "mark")),
    ...shownSeries(place, isHidden).flatMap((series) => paintCurve(place, series)),
  );
  return [
    clip,
    ...paintHead(place, layout.row),
    ...paintMarkLabels(place, layout.row),
    inside,
    rectangle(...box, "frame"),
    ...paintYAxis(place),
    ...paintDots(place, isHidden),
    ...paintPointLabels(place, isHidden),
  ];
}

function shownSeries({ panel }, isHidden) {
  return panel.series.filter((series) => !isHidden(series.key));
}

function paintHead({ label: { lines, top }, scale, panel }, row) {
  const drawn = lines.map((text, place) => label(text, 0, top + row * (place + 0.5), "axis-label"));
  return scale ? [...drawn, ...paintScale(scale, panel.raster, row)] : drawn;
}

/** The colours of a raster with the values of the first and the last. */
function paintScale({ lines, top }, raster, row) {
  const texts = raster.range.map((value) => number(value, 4));
  const [from, to] = [textWidth(texts[0]) + 6, textWidth(texts[0]) + 6 + 160];
  const middle = top + row * (lines.length + 0.5);
  const bar = { x: from, y: pixel(middle - 6), width: to - from, height: 12, preserveAspectRatio: "none" };
  return [
    ...lines.map((text, place) => label(text, 0, top + row * (place + 0.5), "axis-label")),
    label(texts[0], 0, middle),
    label(texts[1], to + 6, middle),
    shape("image", { ...bar, href: scaleImage(raster) }),
    rectangle(from, middle - 6, to, middle + 6, "frame"),
  ];
}

function paintMarkLabels(place, row) {
  return place.marks.labels.flatMap(({ at, label: text, ends, row: above }) => {
    const bottom = place.top - row * above;
    const drawn = label(text, ends ? at - 4 : at + 4, bottom - row / 2, ends ? "at-end" : "at-start");
    return [line(at, bottom - row + 2, at, place.top, "mark-stem"), drawn];
  });
}

function paintGrid({ xTicks }, place) {
  if (place.panel.cells || place.panel.raster) return [];
  return [
    ...xTicks.map(({ at }) =>
      line(acrossOf(place, at), place.top, acrossOf(place, at), place.bottom, "grid"),
    ),
    ...place.ticks.map(({ at }) =>
      line(place.left, downOf(place, at), place.right, downOf(place, at), "grid"),
    ),
  ];
}

function paintYAxis(place) {
  const { left } = place;
  if (place.panel.hasY) {
    return place.ticks.flatMap(({ at, text }) => {
      const y = downOf(place, at);
      return [line(left - TICK, y, left, y, "tick"), label(text, left - TICK - 3, y, "at-end")];
    });
  }
  return place.panel.lanes.map((lane, row) =>
    label(shortened(lane.name, left - TICK - 3), left - TICK - 3, laneMiddle(place, row), "at-end"),
  );
}

function paintXAxis({ xTicks, panels, xLabel, bottom, row, left, right }) {
  const last = panels.at(-1);
  const drawn = panels.flatMap((place) =>
    xTicks.map(({ at }) => {
      const x = acrossOf(place, at);
      return line(x, place.bottom, x, place.bottom + TICK, "tick");
    }),
  );
  for (const { at, text } of xTicks) {
    drawn.push(label(text, acrossOf(last, at), bottom + TICK + row / 2 + 1, "at-middle"));
  }
  xLabel.forEach((text, place) => {
    drawn.push(
      label(text, (left + right) / 2, bottom + TICK + 5 + row * (place + 1.5), "at-middle axis-label"),
    );
  });
  return drawn;
}

function paintBands(place, isHidden) {
  return place.panel.bands
    .filter((band) => !isHidden(bandKey(band)))
    .map(({ from, to, colour }) => {
      const ends = [from, to].map((x) => acrossOf(place, clamp(x, ...place.view)));
      // A tint would change the colours of a raster.
      const kind = place.panel.raster ? "band outline" : "band";
      return rectangle(ends[0], place.top, ends[1], place.bottom, `${kind} ${colourOf(colour)}`);
    });
}

function bandKey(band) {
  return JSON.stringify(["band", band.label, band.colour]);
}

function classKey({ name, colour, stripes }) {
  return JSON.stringify(["class", name, colour, ...stripes]);
}

/** All colours of a class: more than one are stripes, one below the other. */
function coloursOf({ colour, stripes }) {
  return [colour, ...stripes];
}

function paintRaster(place) {
  const { raster } = place.panel;
  if (!raster) return [];
  const [left, right] = raster.x.map((x) => acrossOf(place, x));
  const [bottom, top] = raster.y.map((y) => downOf(place, y));
  raster.image ??= rasterImage(raster);
  const image = shape("image", {
    x: pixel(left),
    y: pixel(top),
    width: pixel(right - left),
    height: pixel(bottom - top),
    preserveAspectRatio: "none",
    href: raster.image,
  });
  // Cells that are large are to be seen as cells; small ones are blended.
  image.style.imageRendering = right - left > 2 * raster.columns ? "pixelated" : "auto";
  return [image];
}

/** The level of a cell, 0 to 254, or 255 for none. */
function levelAt(raster, row, column) {
  return parseInt(raster.rows[row].slice(2 * column, 2 * column + 2), 16);
}

function rasterImage(raster) {
  const height = raster.rows.length;
  return pictureOf(raster.columns, height, raster, (column, row) =>
    levelAt(raster, height - 1 - row, column),
  );
}

function scaleImage(raster) {
  return pictureOf(255, 1, raster, (column) => column);
}

/** Pixels as a picture in a URL. */
function pictureOf(width, height, raster, level) {
  const canvas = element("canvas", { width, height });
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(width, height);
  for (let i = 0; i < width * height; i++) {
    const at = level(i % width, Math.floor(i / width));
    if (at === 255) continue;
    const colour = parseInt(raster.colours.slice(6 * at, 6 * at + 6), 16);
    pixels.data.set([colour >> 16, (colour >> 8) & 255, colour & 255, 255], 4 * i);
  }
  context.putImageData(pixels, 0, 0);
  return canvas.toDataURL();
}

/** One path for each colour of each class, so that a map of many cells stays a small drawing. */
function paintAreas(panel, isHidden, partsOf) {
  return panel.classes.flatMap((one, place) => {
    if (isHidden(classKey(one))) return [];
    return coloursOf(one).map((colour, stripe, { length }) =>
      shape("path", { d: partsOf(place, { stripe, length }), class: `area ${colourOf(colour)}` }),
    );
  });
}

/** The parts of a box that one of `length` stripes takes, which come again from `origin` on, each `high` px. */
function stripesOf([left, top, right, bottom], { stripe, length }, origin, high) {
  if (length === 1) return box(left, top, right, bottom);
  let path = "";
  for (let turn = Math.floor((top - origin) / high + 1e-6); origin + turn * high < bottom - 1e-6; turn++) {
    const upper = Math.max(origin + turn * high, top);
    const lower = Math.min(origin + (turn + 1) * high, bottom);
    if (turn % length === stripe) path += box(left, upper, right, lower);
  }
  return path;
}

function box(left, top, right, bottom) {
  return `M${pixel(left)} ${pixel(top)}H${pixel(right)}V${pixel(bottom)}H${pixel(left)}Z`;
}

function paintCells(place, isHidden) {
  const { cells } = place.panel;
  if (!cells) return [];
  const across = cellEdges(cells.x, cells.columns).map((x) => acrossOf(place, x));
  const down = cellEdges(cells.y, cells.rows.length).map((y) => downOf(place, y));
  return paintAreas(place.panel, isHidden, (wanted, stripes) => {
    let path = "";
    cells.rows.forEach((row, r) => {
      for (let from = 0, to; from < row.length; from = to) {
        for (to = from + 1; to < row.length && row[to] === row[from]; to++);
        if (row[from] !== wanted) continue;
        path += stripesOf([across[from], down[r + 1], across[to], down[r]], stripes, place.top, STRIPE);
      }
    });
    return path;
  });
}

/** Height of the stripes of a map, px. */
const STRIPE = 5;

function laneMiddle({ top }, row) {
  return top + LANE * (row + 0.5);
}

/** A stretch too short to be seen, between long ones, is drawn a pixel wide over them: an impact is to be seen. */
function paintLanes(place, isHidden) {
  const across = (x) => acrossOf(place, clamp(x, ...place.view));
  const width = (stretch) => (stretch ? across(stretch.to) - across(stretch.from) : Infinity);
  const stretches = place.panel.lanes.flatMap((lane, row) =>
    lane.stretches.map((stretch, i) => {
      const beside = Math.min(width(lane.stretches[i - 1]), width(lane.stretches[i + 1]));
      return { ...stretch, row, isEvent: width(stretch) < 1 && beside > 3 };
    }),
  );
  const inView = stretches.filter(({ from, to }) => to >= place.view[0] && from <= place.view[1]);
  const paintOf = (events) =>
    paintAreas(place.panel, isHidden, (wanted, stripes) => {
      const parts = inView.filter(({ of, isEvent }) => of === wanted && isEvent === events);
      return parts
        .map(({ from, to, row }) =>
          laneBox(place, row, across(from), events ? across(from) + 1 : across(to), stripes),
        )
        .join("");
    });
  return [...paintOf(false), ...paintOf(true)];
}

function laneBox(place, row, left, right, stripes) {
  const middle = laneMiddle(place, row);
  const [top, bottom] = [middle - LANE / 2 + 3, middle + LANE / 2 - 3];
  return stripesOf([left, top, right, bottom], stripes, top, (bottom - top) / stripes.length);
}

function paintCurve(place, series) {
  const dotted = series.style === "dots" ? "dots" : series.style === "dashed" ? "curve dashed" : "curve";
  if (!series.isLine && series.marker) return paintMarkers(place, series);
  const path = series.isLine ? linePath(place, series) : dotPath(place, series);
  const curve = shape("path", { d: path, class: `${dotted} ${colourOf(series.colour)}` });
  const markers = series.marker ? paintMarkers(place, series) : [];
  // On the colours of a raster a curve needs an edge.
  return [...(place.panel.raster ? [shape("path", { d: path, class: "casing" })] : []), curve, ...markers];
}

/** The form of each kind of marker about a point, of half the size r. */
const MARKERS = {
  disc: (r) => `m${-r} 0a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`,
  square: (r) => `m${-r} ${-r}h${2 * r}v${2 * r}h${-2 * r}z`,
  triangle: (r) => `m0 ${-1.25 * r}l${1.25 * r} ${2.25 * r}h${-2.5 * r}z`,
  diamond: (r) => `m0 ${-1.5 * r}l${1.5 * r} ${1.5 * r}l${-1.5 * r} ${1.5 * r}l${-1.5 * r} ${-1.5 * r}z`,
  cross: (r) => `m${-r} ${-r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}`,
};
MARKERS.ring = MARKERS.disc;

/** Half of a marker's size, px; a multiple of what pixels are rounded to. */
const MARKER = 4;

function paintMarkers(place, series) {
  const form = MARKERS[series.marker](MARKER);
  const path = dotPath(place, series).replaceAll("h0", form);
  return [shape("path", { d: path, class: `marker ${series.marker} ${colourOf(series.colour)}` })];
}

/** The places of points that may be seen; of a curve along x one more at both ends. */
function seenPlaces(series, view) {
  if (!series.ascending) return [0, series.x.length];
  return [
    Math.max(firstFrom(series.x, view[0]) - 1, 0),
    Math.min(firstFrom(series.x, view[1]) + 2, series.x.length),
  ];
}

function linePath(place, series) {
  let [path, joined] = ["", false];
  const [from, to] = seenPlaces(series, place.view);
  for (let i = from; i < to; i++) {
    if (Number.isNaN(series.y[i])) {
      joined = false;
      continue;
    }
    path += `${joined ? "L" : "M"}${pixel(acrossOf(place, series.x[i]))} ${pixel(downOf(place, series.y[i]))}`;
    // A point alone is seen by the round ends of a line without a length.
    if (!joined && !(i + 1 < to && Number.isFinite(series.y[i + 1]))) path += "h0";
    joined = true;
  }
  return path;
}

/** Round ends make dots of lines without a length. */
function dotPath(place, series) {
  let path = "";
  for (let i = 0; i < series.x.length; i++) {
    if (Number.isNaN(series.y[i]) || series.x[i] < place.view[0] || series.x[i] > place.view[1]) continue;
    path += `M${pixel(acrossOf(place, series.x[i]))} ${pixel(downOf(place, series.y[i]))}h0`;
  }
  return path;
}

/** Points that have labels are dots on their curve. */
function paintDots(place, isHidden) {
  return shownSeries(place, isHidden)
    .filter((series) => series.labels.length && !series.marker)
    .map((series) => shape("path", { d: dotPath(place, series), class: `dots ${colourOf(series.colour)}` }));
}

/** Labels of points where there is room, each at the first free one of four places. */
function paintPointLabels(place, isHidden) {
  const taken = [];
  const drawn = [];
  const free = (area) =>
    area[0] >= place.left &&
    area[2] <= place.right &&
    area[1] >= place.top &&
    area[3] <= place.bottom &&
    !taken.some(
      (other) => area[0] < other[2] && other[0] < area[2] && area[1] < other[3] && other[1] < area[3],
    );
  const points = shownSeries(place, isHidden).flatMap((series) =>
    series.labels.map((text, i) => [text, acrossOf(place, series.x[i]), downOf(place, series.y[i])]),
  );
  points.forEach(([, x, y]) => taken.push([x - 3, y - 3, x + 3, y + 3]));
  for (const [text, x, y] of points) {
    if (!text) continue;
    const width = textWidth(text);
    const places = [
      [8, -10],
      [8, 10],
      [-8 - width, -10],
      [-8 - width, 10],
      [8, 0],
      [-8 - width, 0],
    ];
    for (const [dx, dy] of places) {
      const area = [x + dx, y + dy - 7, x + dx + width, y + dy + 7];
      if (!free(area)) continue;
      taken.push(area);
      drawn.push(label(text, x + dx, y + dy, "beside"));
      break;
    }
  }
  return drawn;
}
