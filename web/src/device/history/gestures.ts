/** Wheel, fingers and a held mouse move a chart's time axis; a finger on a chart that is not zoomed reads its values. */
import type uPlot from "uplot";
import { type Held, held, lengthOf, moved, type Span, stretched } from "./span";
import type { TimeAxis } from "./timeAxis";

/** Pixels of a line, for wheels that count lines. */
const LINE = 18;
/** A wheel's step changes the length by so much at most. */
const STEP = 1.35;

/** Listen on a chart; gives the function that ends it. */
export function listen(plot: uPlot, axis: TimeAxis): () => void {
  const hand = new Hand(plot, axis);
  const over = plot.over;
  const ending = new AbortController();
  const { signal } = ending;
  over.addEventListener("wheel", (event) => turn(event, plot, axis), { signal, passive: false });
  over.addEventListener("pointerdown", (event) => hand.down(event), { signal });
  over.addEventListener("pointermove", (event) => hand.move(event), { signal });
  for (const end of ["pointerup", "pointercancel"] as const)
    over.addEventListener(end, (event) => hand.up(event), { signal });
  return () => ending.abort();
}

/** With ctrl (as pinching a touchpad gives it) the wheel zooms; without it moves what is zoomed, as far as that goes. */
function turn(event: WheelEvent, plot: uPlot, axis: TimeAxis): void {
  const span = axis.span;
  if (!span) return;
  const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE : 1;
  const { left, width } = plot.rect;
  if (event.ctrlKey || event.metaKey) {
    event.preventDefault();
    const factor = Math.min(Math.max(Math.exp(event.deltaY * pixels * 0.01), 1 / STEP), STEP);
    const about = span.min + ((event.clientX - left) / width) * lengthOf(span);
    axis.look(stretched(span, factor, about));
    return;
  }
  const along = Math.abs(event.deltaX) > Math.abs(event.deltaY) ? event.deltaX : event.deltaY;
  if (axis.chosen && axis.look(moved(span, (along * pixels) / width))) event.preventDefault();
}

/** The pointers that are down on one chart. */
class Hand {
  private readonly pointers = new Map<number, Held>();
  private span: Span | null = null;

  constructor(
    private readonly plot: uPlot,
    private readonly axis: TimeAxis,
  ) {}

  down(event: PointerEvent): void {
    if (event.pointerType === "mouse" && !event.shiftKey) return;
    this.pointers.set(event.pointerId, this.hold(event));
    if (event.pointerType === "mouse") this.plot.over.setPointerCapture(event.pointerId);
  }

  move(event: PointerEvent): void {
    const known = this.pointers.get(event.pointerId);
    if (!known) return;
    const x = event.clientX - this.plot.rect.left;
    this.pointers.set(event.pointerId, { ...known, x });
    if (this.axis.chosen || this.pointers.size > 1 || event.pointerType === "mouse") this.pull();
    else this.plot.setCursor({ left: x, top: 0 });
  }

  up(event: PointerEvent): void {
    this.pointers.delete(event.pointerId);
    this.holdAgain();
  }

  private pull(): void {
    const [one, two] = this.pointers.values();
    if (this.span && one) this.axis.look(held(this.span, [one, two], this.plot.rect.width));
  }

  /** Another finger has come or gone: from now on each holds the moment that it is on. */
  private hold(event: PointerEvent): Held {
    this.holdAgain();
    return this.at(event.clientX - this.plot.rect.left);
  }

  private holdAgain(): void {
    this.span = this.axis.span;
    for (const [id, { x }] of this.pointers) this.pointers.set(id, this.at(x));
  }

  private at(x: number): Held {
    const { min, max } = this.span ?? { min: 0, max: 0 };
    return { time: min + (x / this.plot.rect.width) * (max - min), x };
  }
}
