/** The time axis that several charts share. What is loaded moves at once; when it has come to rest, more is asked for. */
import type uPlot from "uplot";
import { inside, lengthOf, type Span } from "./span";

/** ms without a move: it rests */
const REST = 200;

const beyond = (span: Span, loaded: Span): boolean => span.min < loaded.min || span.max > loaded.max;

export class TimeAxis {
  /** what there is to look at */
  limits: Span | null = null;
  /** what has been asked for */
  loaded: Span | null = null;
  onRest: (span: Span) => void = () => {};
  /** what is looked at; null: all that is loaded */
  chosen: Span | null = null;
  private readonly plots = new Set<uPlot>();
  private frame: number | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;

  add(plot: uPlot): () => void {
    this.plots.add(plot);
    return () => this.plots.delete(plot);
  }

  /** What the charts show now. */
  get span(): Span | null {
    if (this.chosen) return this.chosen;
    for (const { scales } of this.plots) {
      const { min, max } = scales.x ?? {};
      if (min != null && max != null) return { min, max };
    }
    return null;
  }

  /** Look somewhere else, as far as there is something; tells whether that is a change. */
  look(wanted: Span): boolean {
    const before = this.span;
    const span = this.limits ? inside(wanted, this.limits) : wanted;
    if (before && Math.abs(span.min - before.min) + Math.abs(span.max - before.max) < 1e-6 * lengthOf(span))
      return false;
    this.chosen = span;
    this.frame ??= requestAnimationFrame(() => this.draw());
    this.report(span);
    return true;
  }

  /** Back to all that is loaded. */
  reset(): void {
    this.stop();
    this.chosen = null;
  }

  stop(): void {
    this.forget();
    if (this.frame !== undefined) cancelAnimationFrame(this.frame);
    this.frame = undefined;
  }

  /** Tell when it rests; and on the way, when it comes to where nothing is loaded yet. */
  private report(span: Span): void {
    if (!this.loaded || !beyond(span, this.loaded)) this.forget();
    this.timer ??= setTimeout(() => {
      this.timer = undefined;
      if (this.chosen) this.onRest(this.chosen);
    }, REST);
  }

  private forget(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
  }

  private draw(): void {
    this.frame = undefined;
    if (!this.chosen) return;
    for (const plot of this.plots) plot.setScale("x", this.chosen);
  }
}
