/** The one file that talks HTTP: typed requests, and errors in the service's own words. */
import createClient from "openapi-fetch";
import type { paths } from "./schema";

/** An answer that is not a success: RFC 9457 problem details, or no answer at all (status 0). */
export class Problem extends Error {
  constructor(
    readonly status: number,
    message: string,
    /** wrong fields of a form: name -> what was expected */
    readonly fields: Readonly<Record<string, string>> = {},
  ) {
    super(message);
  }
}

export const http = createClient<paths>({ baseUrl: "/" });

http.use({
  onError() {
    return new Problem(0, "The service does not answer.");
  },
});

/** Give the document of a successful answer, or throw the `Problem`. */
export async function answer<T>(
  request: Promise<{ data?: T; error?: unknown; response: Response }>,
): Promise<T> {
  const { data, error, response } = await request;
  if (!response.ok) throw problem(response.status, error);
  return data as T;
}

/** The description of the API, as far as the page reads it. */
export async function openApi(): Promise<{ info: { version: string } }> {
  const response = await fetch("/openapi.json").catch(() => {
    throw new Problem(0, "The service does not answer.");
  });
  if (!response.ok) throw problem(response.status, null);
  return response.json();
}

function problem(status: number, body: unknown): Problem {
  const detail = text(body, "detail") ?? text(body, "title");
  return new Problem(status, detail ?? `The service answered with status ${status}.`, fields(body));
}

function text(body: unknown, name: string): string | undefined {
  const value = isRecord(body) ? body[name] : undefined;
  return typeof value === "string" && value !== "" ? value : undefined;
}

/** `errors[].pointer` such as `/body/name` names the field of a form. */
function fields(body: unknown): Record<string, string> {
  const errors = isRecord(body) && Array.isArray(body.errors) ? body.errors : [];
  const named = errors.flatMap((error) => {
    const pointer = text(error, "pointer");
    return pointer?.startsWith("/body/")
      ? [[pointer.slice(6), text(error, "message") ?? "is not valid"]]
      : [];
  });
  return Object.fromEntries(named);
}

function isRecord(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null;
}
