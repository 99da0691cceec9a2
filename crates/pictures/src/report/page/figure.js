// A figure that answers: crosshair, zoom and a legend of switches, for mouse, touch and keyboard.

/** A drag that is shorter than this is a click, px. */
const DRAG = 6;
/** The part of the whole range that can be zoomed to. */
const FINEST = 1e-4;
/** How far an arrow key goes, as a part of the range that is shown; at least to the next point. */
const STRIDE = 1 / 100;

/** A line of the crosshair, with an edge that keeps it apart from any colour. */
function hair(...ends) {
  return [line(...ends, "crosshair-edge"), line(...ends, "crosshair")];
}

/** What stands for an entry of a legend: 28 × 14 px. */
function sampleOf(colours, kind, marker) {
  const high = 12 / colours.length;
  const drawn = colours.map((colour, i) => {
    if (kind === "band" || kind === "area") return rectangle(3, 1 + i * high, 25, 1 + (i + 1) * high, kind);
    return shape("path", { d: kind === "dots" ? "M14 7h0" : "M1 7H27", class: kind });
  });
  if (marker) {
    if (kind === "dots") drawn.pop();
    drawn.push(shape("path", { d: `M14 7${MARKERS[marker](MARKER)}`, class: `marker ${marker}` }));
  }
  drawn.forEach((sample, i) => sample.classList.add(...colourOf(colours[i] ?? colours[0]).split(" ")));
  return drawn;
}

class ChartFigure {
  constructor(figure) {
    this.data = readValues(figure.querySelector('script[type="application/json"]').textContent);
    this.reading = readingOf(this.data);
    this.view = this.data.full;
    this.hidden = new Set();
    this.isHidden = (key) => this.hidden.has(key);
    /** Along x: { x, panel, y }, where panel and y are the pointer's; else { panel, series, point } or { column, row }. */
    this.cursor = null;
    this.build(figure.querySelector(".stage"), figure.querySelector("h3").textContent);
    // A figure has no width before it is laid out, and another one when a phone is turned.
    new ResizeObserver(() => this.fit()).observe(this.plot);
    this.fit();
  }

  build(stage, title) {
    this.plot = element("div", {
      class: "plot",
      tabindex: "0",
      role: "application",
      "aria-label": `Chart: ${title}. ${this.help()}`,
    });
    this.live = element("p", { class: "unseen live", "aria-live": "polite" });
    this.whole = this.button("Whole range", () => this.zoomTo(this.data.full));
    const zoom = element(
      "div",
      { class: "zoom", role: "group", "aria-label": "Zoom" },
      this.button("−", () => this.zoomBy(2), "Zoom out"),
      this.button("+", () => this.zoomBy(0.5), "Zoom in"),
      this.whole,
    );
    stage.append(element("div", { class: "tools" }, this.legend(), zoom), this.plot, this.live);
    this.listen();
  }

  help() {
    const arrows = {
      along: "Left and right arrow keys read values",
      points: "Arrow keys go along a curve and between curves",
      cells: "Arrow keys go from cell to cell",
    };
    return `${arrows[this.reading]}; plus and minus zoom, Escape shows the whole range.`;
  }

  button(text, act, name) {
    const button = element("button", { type: "button", "aria-label": name, title: name }, text);
    button.addEventListener("click", act);
    return button;
  }

  // ---- Legend ----

  legend() {
    const entries = new Map();
    for (const panel of this.data.panels) {
      for (const { key, label: text, colour, style, labels, marker } of panel.series) {
        if (text)
          entries.set(key, {
            text,
            colours: [colour],
            marker,
            kind: style === "line" && !labels.length ? "curve" : style === "dashed" ? "curve dashed" : "dots",
          });
      }
      for (const band of panel.bands) {
        if (band.label) entries.set(bandKey(band), { text: band.label, colours: [band.colour], kind: "band" });
      }
      for (const one of panel.classes)
        entries.set(classKey(one), { text: one.name, colours: coloursOf(one), kind: "area" });
    }
    const buttons = [...entries].map(([key, entry]) => this.switchOf(key, entry));
    return element("div", { class: "legend", role: "group", "aria-label": "Show or hide" }, ...buttons);
  }

  switchOf(key, { text, colours, kind, marker }) {
    const samples = sampleOf(colours, kind, marker);
    const button = element(
      "button",
      { type: "button", "aria-pressed": "true" },
      shape("svg", { width: 28, height: 14, "aria-hidden": "true" }, ...samples),
      text,
    );
    button.addEventListener("click", () => {
      if (!this.hidden.delete(key)) this.hidden.add(key);
      button.setAttribute("aria-pressed", String(!this.hidden.has(key)));
      this.draw();
    });
    return button;
  }

  // ---- Drawing ----

  fit() {
    const width = Math.floor(this.plot.clientWidth);
    if (width > 0 && width !== this.width) {
      this.width = width;
      this.draw();
    }
  }

  draw() {
    if (!this.width) return;
    this.layout = layoutOf(this.data, this.width, this.view, this.isHidden);
    this.drawing = paint(this.layout, this.isHidden);
    this.over = shape("g", { class: "over" });
    this.drawing.append(this.over);
    this.plot.replaceChildren(this.drawing);
    this.whole.setAttribute("aria-disabled", String(!this.isZoomed()));
    this.showCursor();
  }

  isZoomed() {
    return this.view !== this.data.full;
  }

  // ---- Crosshair ----

  /** Draws the crosshair and the boxes with its values; nothing where there is none. */
  showCursor() {
    this.over.replaceChildren();
    this.plot.querySelectorAll(".values").forEach((box) => box.remove());
    if (!this.cursor) return;
    if (this.reading === "along") this.showAlong();
    else this.showPlace(this.placeOfCursor());
  }

  showAlong() {
    const at = acrossOf(this.layout, this.cursor.x);
    this.layout.panels.forEach((place, i) => {
      this.over.append(...hair(at, place.top, at, place.bottom));
      const lines = this.linesAlong(place);
      for (const { series, at: value, colour } of lines) {
        if (series) this.over.append(this.dot(at, downOf(place, value), colour));
      }
      if (this.pointedAt(place) !== undefined) {
        const y = downOf(place, this.cursor.y);
        this.over.append(...hair(place.left, y, place.right, y));
      }
      this.showValues(place, at, i === 0 ? [this.lineOfX(), ...lines] : lines);
    });
  }

  linesAlong(place) {
    return linesAlong(place, this.cursor.x, {
      data: this.data,
      isHidden: this.isHidden,
      y: this.pointedAt(place),
    });
  }

  /** y of the pointer where it has a meaning: over a raster. */
  pointedAt(place) {
    return place.panel.raster && this.cursor.panel === place.panel ? this.cursor.y : undefined;
  }

  lineOfX() {
    return { name: this.data.xLabel, value: number(this.data.unscaled(this.cursor.x)) };
  }

  /** The cursor of a figure that is read point by point, or by cells: its panel, x, y and lines. */
  placeOfCursor() {
    if (this.reading === "cells") {
      const { column, row } = this.cursor;
      const { cells } = this.data.panels[0];
      const middle = ([from, to], count, place) =>
        count === 1 ? (from + to) / 2 : from + ((to - from) * place) / (count - 1);
      return {
        place: this.layout.panels[0],
        x: middle(cells.x, cells.columns, column),
        y: middle(cells.y, cells.rows.length, row),
        lines: linesOfCell(this.data, this.data.panels[0], column, row),
      };
    }
    const { panel, series, point } = this.cursor;
    return {
      place: this.layout.panels.find((place) => place.panel === panel),
      x: series.x[point],
      y: series.y[point],
      lines: linesOfPoint(this.data, panel, series, point),
      colour: series.colour,
    };
  }

  showPlace({ place, x, y, lines, colour }) {
    const [across, down] = [acrossOf(place, x), downOf(place, y)];
    this.over.append(
      ...hair(across, place.top, across, place.bottom),
      ...hair(place.left, down, place.right, down),
    );
    if (colour !== undefined) this.over.append(this.dot(across, down, colour));
    this.showValues(place, across, lines);
  }

  dot(x, y, colour) {
    return shape("circle", { cx: pixel(x), cy: pixel(y), r: 4, class: `point ${colourOf(colour)}` });
  }

  /** A box of values in a panel, on the side of the crosshair that has more room. */
  showValues(place, at, lines) {
    if (!lines.length) return;
    const most = Math.max(2, Math.floor((place.height - 8) / this.layout.row));
    const left = lines.length > most ? lines.length - most + 1 : 0;
    const box = element("div", { class: "values", "aria-hidden": "true" });
    for (const { name, value, colour, stripes = [] } of left ? lines.slice(0, most - 1) : lines) {
      const colours = colour === undefined ? [] : [colour, ...stripes];
      const dot = colours.map((colour) => element("i", { class: colourOf(colour) }));
      box.append(element("div", {}, ...dot, value ? `${name}: ` : name, element("b", {}, value)));
    }
    if (left) box.append(element("div", {}, `and ${left} more`));
    box.style.top = `${place.top + 4}px`;
    box.style.fontSize = `${this.layout.size}px`;
    this.plot.append(box);
    const room = at - place.left > (place.right - place.left) / 2;
    box.style.maxWidth = `${Math.max(room ? at - 10 : this.width - at - 12, 120)}px`;
    box.style.left = `${room ? Math.max(at - box.offsetWidth - 10, 0) : at + 10}px`;
  }

  /** The crosshair's values in words, for those who do not see them. */
  say() {
    if (!this.cursor) return;
    this.live.textContent = this.reading === "along" ? this.sayAlong() : spoken(this.placeOfCursor().lines);
  }

  sayAlong() {
    const parts = this.layout.panels.map((place) => {
      const text = spoken(this.linesAlong(place));
      return text && this.layout.panels.length > 1 && place.panel.hasY
        ? `${place.panel.yLabel}: ${text}`
        : text;
    });
    return [spoken([this.lineOfX()]), ...parts].filter(Boolean).join("; ");
  }

  moveTo(cursor) {
    this.cursor = cursor;
    this.showCursor();
  }

  // ---- Pointer ----

  listen() {
    const { plot } = this;
    plot.addEventListener("pointerdown", (event) => this.press(event));
    plot.addEventListener("pointermove", (event) => this.move(event));
    plot.addEventListener("pointerup", (event) => this.release(event));
    plot.addEventListener("pointercancel", () => this.endDrag());
    plot.addEventListener(
      "pointerleave",
      (event) => event.pointerType === "mouse" && !this.drag && this.moveTo(null),
    );
    plot.addEventListener("dblclick", () => this.zoomTo(this.data.full));
    plot.addEventListener("keydown", (event) => this.pressKey(event));
    plot.addEventListener("focus", () => plot.matches(":focus-visible") && !this.cursor && this.begin());
    plot.addEventListener("blur", () => this.moveTo(null));
  }

  position(event) {
    const box = this.plot.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** A mouse selects a range; a finger reads values, for it scrolls, too, and has the buttons to zoom. */
  press(event) {
    const [at] = this.position(event);
    if (event.pointerType === "mouse" && event.button === 0 && at >= this.layout.left) {
      this.drag = { from: at };
      this.plot.setPointerCapture(event.pointerId);
    } else {
      this.read(event);
    }
  }

  move(event) {
    const [at] = this.position(event);
    if (this.drag && Math.abs(at - this.drag.from) > DRAG) this.select(at);
    else if (!this.drag) this.read(event);
  }

  select(at) {
    const { left, right, panels } = this.layout;
    this.drag.to = clamp(at, left, right);
    const ends = [this.drag.from, this.drag.to].sort((a, b) => a - b);
    this.cursor = null;
    this.showCursor();
    this.over.append(
      ...panels.map(({ top, bottom }) => rectangle(ends[0], top, ends[1], bottom, "selection")),
    );
  }

  release() {
    const ends = this.drag?.to === undefined ? null : [this.drag.from, this.drag.to].sort((a, b) => a - b);
    this.endDrag();
    if (ends) this.zoomTo(ends.map((at) => valueAcross(this.layout, at)));
  }

  endDrag() {
    this.drag = null;
    this.showCursor();
  }

  /** Puts the crosshair where the pointer is, or at what is nearest to it. */
  read(event) {
    const [at, down] = this.position(event);
    const { left, right, panels } = this.layout;
    if (at < left - 10 || at > right + 10) return;
    const x = clamp(valueAcross(this.layout, at), ...this.view);
    const place = panels.find(({ top, bottom }) => down >= top && down <= bottom);
    if (this.reading === "along") {
      const y = place?.panel.hasY ? valueDown(place, down) : undefined;
      this.moveTo({ x: this.stopNear(x), panel: place?.panel, y });
    } else if (this.reading === "cells" && place) {
      this.moveTo(this.cellAt(x, valueDown(place, down)));
    } else if (place) {
      this.moveTo(this.pointNear(place, at, down));
    }
  }

  stopNear(x) {
    return this.data.stops[nearest(this.data.stops, x)];
  }

  cellAt(x, y) {
    const { cells } = this.data.panels[0];
    const placeIn = ([from, to], count, value) =>
      clamp(Math.round(((value - from) / (to - from)) * (count - 1)), 0, count - 1);
    return { column: placeIn(cells.x, cells.columns, x), row: placeIn(cells.y, cells.rows.length, y) };
  }

  pointNear(place, at, down) {
    let [best, found] = [Infinity, null];
    for (const series of shownSeries(place, this.isHidden)) {
      for (let point = 0; point < series.x.length; point++) {
        const away = Math.hypot(acrossOf(place, series.x[point]) - at, downOf(place, series.y[point]) - down);
        if (away < best) [best, found] = [away, { panel: place.panel, series, point }];
      }
    }
    return found;
  }

  // ---- Keyboard ----

  pressKey(event) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
    const acts = {
      Home: () => this.toEnd(0),
      End: () => this.toEnd(1),
      "+": () => this.zoomBy(0.5),
      "=": () => this.zoomBy(0.5),
      "-": () => this.zoomBy(2),
      Escape: () => this.leave(),
    };
    const step = steps[event.key];
    // Up and down scroll the page where they have nothing to read.
    if (event.ctrlKey || event.metaKey || event.altKey || (step?.[1] && this.reading === "along")) return;
    if (step) this.step(...step, event.shiftKey);
    else if (acts[event.key]) acts[event.key]();
    else return;
    event.preventDefault();
  }

  /** The crosshair of a reader who comes by keyboard. */
  begin() {
    const x = (this.view[0] + this.view[1]) / 2;
    if (this.reading === "along") this.moveTo({ x: this.stopNear(x) });
    else if (this.reading === "cells")
      this.moveTo(this.cellAt(x, (this.data.panels[0].cells.y[0] + this.data.panels[0].cells.y[1]) / 2));
    else this.moveTo(this.firstPoint());
    this.say();
  }

  firstPoint() {
    return this.readableCurves()[0] ?? null;
  }

  /** Each curve that is shown, with its first point. */
  readableCurves() {
    return this.data.panels.flatMap((panel) =>
      panel.series
        .filter((series) => !this.isHidden(series.key))
        .map((series) => ({
          panel,
          series,
          point: series.y.findIndex((y, i) => Number.isFinite(y + series.x[i])),
        }))
        .filter(({ point }) => point >= 0),
    );
  }

  step(across, up, isFine) {
    if (!this.cursor) this.begin();
    else {
      const step = { along: this.stepAlong, cells: this.stepCells, points: this.stepPoints }[this.reading];
      this.moveTo(step.call(this, across, up, isFine));
      this.say();
    }
  }

  stepAlong(across, _, isFine) {
    const { stops } = this.data;
    const far = isFine ? 0 : STRIDE * (this.view[1] - this.view[0]);
    const { x } = this.cursor;
    // Rounding of the stride must not leave out the point that is that far away.
    const slack = 1e-9 * (this.view[1] - this.view[0]);
    const place =
      across > 0
        ? Math.max(firstFrom(stops, x + far - slack), firstFrom(stops, x) + 1)
        : Math.min(firstFrom(stops, x - far + slack) - 1, firstFrom(stops, x) - 1);
    const to = stops[clamp(place, 0, stops.length - 1)];
    return { x: to >= this.view[0] && to <= this.view[1] ? to : x };
  }

  stepCells(across, up, isFine) {
    const { columns, rows } = this.data.panels[0].cells;
    const far = (count) => (isFine ? 1 : Math.max(1, Math.round(count / 50)));
    const { column, row } = this.cursor;
    return {
      column: clamp(column + across * far(columns), 0, columns - 1),
      row: clamp(row + up * far(rows.length), 0, rows.length - 1),
    };
  }

  stepPoints(across, up, isFine) {
    const curves = this.readableCurves();
    const current = curves.findIndex(({ series }) => series === this.cursor.series);
    if (up || current < 0) return curves.at((current - up) % curves.length) ?? null;
    const { series, point } = this.cursor;
    const far = isFine ? 1 : Math.max(1, Math.round(series.x.length * STRIDE));
    let to = clamp(point + across * far, 0, series.x.length - 1);
    while (!Number.isFinite(series.y[to]) && to > 0 && to < series.x.length - 1) to += across;
    return Number.isFinite(series.y[to]) ? { ...this.cursor, point: to } : this.cursor;
  }

  toEnd(end) {
    this.begin();
    if (this.reading === "along") {
      const { stops } = this.data;
      this.moveTo({
        x: end
          ? (stops[firstFrom(stops, this.view[1] * (1 + Math.sign(this.view[1]) * 1e-12)) - 1] ?? stops[0])
          : stops[firstFrom(stops, this.view[0])],
      });
    } else if (this.reading === "cells") {
      this.moveTo({ ...this.cursor, column: end ? this.data.panels[0].cells.columns - 1 : 0 });
    } else if (this.cursor) {
      this.moveTo({
        ...this.cursor,
        point: end ? this.cursor.series.y.findLastIndex(Number.isFinite) : this.cursor.point,
      });
    }
    this.say();
  }

  leave() {
    if (this.isZoomed()) this.zoomTo(this.data.full);
    else this.moveTo(null);
  }

  // ---- Zoom ----

  zoomBy(factor) {
    const [from, to] = this.view;
    const about = this.cursor
      ? this.reading === "along"
        ? this.cursor.x
        : this.placeOfCursor().x
      : (from + to) / 2;
    this.zoomTo([about - factor * (about - from), about + factor * (to - about)]);
  }

  zoomTo([from, to]) {
    const { full, xLabel, unscaled } = this.data;
    if (to - from < FINEST * (full[1] - full[0])) return;
    const view = [Math.max(from, full[0]), Math.min(to, full[1])];
    this.view = view[0] === full[0] && view[1] === full[1] ? full : view;
    if (this.cursor?.x < this.view[0] || this.cursor?.x > this.view[1]) this.cursor = null;
    this.draw();
    const ends = this.view.map((x) => number(unscaled(x), 4));
    this.live.textContent = `${this.isZoomed() ? "Shown" : "Whole range"}: ${xLabel} from ${ends[0]} to ${ends[1]}`;
  }
}
