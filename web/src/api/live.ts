/** The one file that is live: server-sent events keep the cache of `queries.ts` true. */
import type { QueryClient, QueryKey } from "@tanstack/react-query";
import { apply, type LiveEvent } from "./apply";
import { keys } from "./keys";
import { Pace } from "./pace";

export type LiveStatus = "connecting" | "live" | "reconnecting" | "asleep";

const TYPES = ["installation", "alert", "device"] as const;

/** ms; events are applied together, so that a busy fleet does not make the page flicker. */
const BATCH = 150;
/** ms; the browser reconnects by itself except after a refusal; then wait this long, doubling. */
const RETRY = { first: 1000, longest: 30_000 };
/** ms; a page that nobody looks at lets go of its connection after this. */
const HIDDEN = 30_000;

type Timer = ReturnType<typeof setTimeout> | undefined;

/** Open the stream and keep it open; gives the function that closes it. */
export function connect(client: QueryClient, onStatus: (status: LiveStatus) => void): () => void {
  const stream = new LiveStream(client, onStatus);
  stream.open();
  document.addEventListener("visibilitychange", stream.onVisibility);
  addEventListener("offline", stream.onOffline);
  addEventListener("online", stream.onVisibility);
  return () => {
    document.removeEventListener("visibilitychange", stream.onVisibility);
    removeEventListener("offline", stream.onOffline);
    removeEventListener("online", stream.onVisibility);
    stream.stop();
  };
}

class LiveStream {
  private readonly refetch: Refetch;
  private source: EventSource | undefined;
  private delay = RETRY.first;
  private waiting: LiveEvent[] = [];
  private batch: Timer;
  private retry: Timer;
  private hide: Timer;

  constructor(
    private readonly client: QueryClient,
    private readonly onStatus: (status: LiveStatus) => void,
  ) {
    this.refetch = new Refetch(client);
  }

  open(): void {
    this.close();
    const source = new EventSource("/api/v1/stream");
    source.onopen = () => this.opened();
    source.onerror = () => this.dropped(source);
    for (const type of TYPES) {
      source.addEventListener(type, (message: MessageEvent<string>) => this.receive(type, message.data));
    }
    this.source = source;
  }

  close(): void {
    clearTimeout(this.retry);
    this.source?.close();
    this.source = undefined;
  }

  stop(): void {
    for (const timer of [this.hide, this.batch]) clearTimeout(timer);
    this.refetch.stop();
    this.close();
  }

  readonly onVisibility = (): void => {
    clearTimeout(this.hide);
    if (document.hidden) this.hide = setTimeout(() => this.sleep(), HIDDEN);
    else if (!this.source) this.open();
  };

  /** A stream whose network is gone ends only when TCP gives it up, much later. */
  readonly onOffline = (): void => {
    this.close();
    this.onStatus("reconnecting");
  };

  private sleep(): void {
    this.close();
    this.onStatus("asleep");
  }

  /** Whatever happened before the stream was open, or while it was away, is read again; then events resume. */
  private opened(): void {
    this.delay = RETRY.first;
    this.onStatus("live");
    this.client.invalidateQueries({ predicate: ({ queryKey }) => queryKey[0] !== keys.session[0] });
  }

  private dropped(source: EventSource): void {
    this.onStatus("reconnecting");
    if (source.readyState !== EventSource.CLOSED) return;
    this.retry = setTimeout(() => this.open(), this.delay);
    this.delay = Math.min(this.delay * 2, RETRY.longest);
  }

  private receive(type: LiveEvent["type"], data: string): void {
    this.waiting.push({ type, data: JSON.parse(data) } as LiveEvent);
    this.batch ??= setTimeout(() => this.flush(), BATCH);
  }

  private flush(): void {
    this.batch = undefined;
    const events = this.waiting;
    this.waiting = [];
    for (const event of events) apply(this.client, event, (key) => this.refetch.soon(key));
  }
}

/** Reads again what was named, each at its own pace. */
class Refetch {
  private readonly paces = new Map<string, Pace>();

  constructor(private readonly client: QueryClient) {}

  soon(queryKey: QueryKey): void {
    const name = JSON.stringify(queryKey);
    const again = () => this.client.invalidateQueries({ queryKey });
    const pace = this.paces.get(name) ?? new Pace(again, () => this.paces.delete(name));
    this.paces.set(name, pace);
    pace.soon();
  }

  stop(): void {
    for (const pace of this.paces.values()) pace.stop();
  }
}
