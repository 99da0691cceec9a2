// Numbers: ticks of axes and texts of values.

const MINUS = "\u2212";

/** A value with some significant digits, without an exponent where it is neither tiny nor huge. */
function number(value, digits = 5, plain = undefined) {
  if (!Number.isFinite(value)) return "–";
  const short = Number(value.toPrecision(digits));
  const size = Math.abs(short);
  const isPlain = plain ?? (short === 0 || (size >= 1e-4 && size < 1e6));
  const text = isPlain ? decimal(short) : short.toExponential().replace("e+", "e");
  return text.replaceAll("-", MINUS);
}

/** JavaScript alone turns to exponents below 1e-6. */
function decimal(short) {
  const text = String(short);
  return text.includes("e") ? short.toFixed(12).replace(/0+$/, "") : text;
}

/** Ticks at round values within a range, no more than about `most`: [{ at, text }]. */
function ticks([from, to], most) {
  const rough = (to - from) / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9));
  const largest = Math.max(Math.abs(from), Math.abs(to));
  const digits = Math.floor(Math.log10(largest)) - Math.floor(Math.log10(step * 1.0001)) + 1;
  const plain = largest >= 1e-3 && largest < 1e6;
  const found = [];
  for (let i = Math.ceil(from / step - 1e-9); i * step <= to + 1e-9 * step; i++) {
    found.push({ at: i * step, text: i === 0 ? "0" : number(i * step, clamp(digits, 1, 15), plain) });
  }
  return found;
}

/** Ticks of an axis of decimal logarithms: powers of ten; within less than two of them 1, 2 and 5. */
function logarithmicTicks([from, to], most) {
  const found = [];
  if (to - from < 2) {
    for (let power = Math.floor(from); power <= to; power++) {
      found.push(
        ...[1, 2, 5].map((digit) => power + Math.log10(digit)).filter((at) => at >= from && at <= to),
      );
    }
  } else {
    const apart = [1, 2, 3, 4, 6, 10, 20, 50, 100].find((step) => (to - from) / step <= most) ?? 100;
    for (let at = Math.ceil(from / apart) * apart; at <= to; at += apart) found.push(at);
  }
  const plain = found.every((at) => at > -3.5 && at < 5);
  return found.map((at) => ({ at, text: number(10 ** at, 1, plain) }));
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** From the smallest to the largest finite value; undefined where there is none. */
function extent(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low && value > -Infinity) low = value;
    if (value > high && value < Infinity) high = value;
  }
  return low <= high ? [low, high] : undefined;
}

/** A range that is not empty, with a part of it as room at both ends. */
function roomy([from, to], part) {
  if (to - from <= 1e-9 * Math.max(Math.abs(from), Math.abs(to))) {
    const around = from === 0 ? 1 : 0.1 * Math.abs(from);
    return [from - around, to + around];
  }
  return [from - part * (to - from), to + part * (to - from)];
}

/** The place of the first value in an ascending list that is not below `wanted`. */
function firstFrom(list, wanted) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The place of the value in an ascending list that is nearest to `wanted`. */
function nearest(list, wanted) {
  const next = firstFrom(list, wanted);
  if (next === 0) return 0;
  if (next === list.length) return next - 1;
  return wanted - list[next - 1] <= list[next] - wanted ? next - 1 : next;
}
