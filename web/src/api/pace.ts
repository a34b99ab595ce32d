/** ms; what is not in an event itself is read again at most this often, */
const REST = 2000;
/** and rests so many times as long as it took to read: a long list is many requests. */
const REST_TIMES = 4;

type Timer = ReturnType<typeof setTimeout> | undefined;

/** Does something when asked, and never forgets, but rests after each time. */
export class Pace {
  private timer: Timer;
  private wanted = false;
  private stopped = false;

  constructor(
    private readonly act: () => Promise<unknown>,
    /** rested, and nothing is wanted */
    private readonly onIdle: () => void,
  ) {}

  soon(): void {
    this.wanted = true;
    this.timer ??= setTimeout(() => this.now(), 0);
  }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.timer);
  }

  private async now(): Promise<void> {
    this.wanted = false;
    const began = performance.now();
    await this.act();
    const rest = Math.max(REST, REST_TIMES * (performance.now() - began));
    if (!this.stopped) this.timer = setTimeout(() => this.rested(), rest);
  }

  private rested(): void {
    if (this.wanted) this.now();
    else this.onIdle();
  }
}
