// Elements of the page and of drawings, and how wide texts are.

const SVG = "http://www.w3.org/2000/svg";

/** An element of the page: attributes, then children (elements or texts). */
function element(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

/** An element of a drawing. */
function shape(name, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function line(x1, y1, x2, y2, kind) {
  const [a, b, c, d] = [x1, y1, x2, y2].map(pixel);
  return shape("path", { d: `M${a} ${b}L${c} ${d}`, class: kind });
}

function rectangle(left, top, right, bottom, kind) {
  const box = { x: pixel(left), y: pixel(top) };
  return shape("rect", {
    ...box,
    width: pixel(Math.max(right - left, 0)),
    height: pixel(bottom - top),
    class: kind,
  });
}

/** A text whose middle height is at y. */
function label(text, x, y, kind) {
  return shape("text", { x: pixel(x), y: pixel(y), dy: "0.35em", class: kind }, text);
}

/** Tenths are enough, and keep paths short. */
function pixel(value) {
  return Math.round(value * 10) / 10;
}

const pen = document.createElement("canvas").getContext("2d");

function setTextSize(size) {
  pen.font = `${size}px ${getComputedStyle(document.body).fontFamily}`;
}

function textWidth(text) {
  return pen.measureText(text).width;
}

/** A text in lines that are not wider than this, if its words are not. */
function wrapped(text, width) {
  const lines = [];
  for (const word of text.split(" ")) {
    const longer = lines.length ? `${lines.at(-1)} ${word}` : word;
    if (lines.length && textWidth(longer) <= width) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

function shortened(text, width) {
  if (textWidth(text) <= width) return text;
  let end = text.length;
  while (end > 1 && textWidth(`${text.slice(0, end)}…`) > width) end--;
  return `${text.slice(0, end).trimEnd()}…`;
}
