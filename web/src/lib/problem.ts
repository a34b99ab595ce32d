/** What went wrong, in the reader's language. */
import { Problem } from "../api/http";
import { language, t } from "../text";

/** The service explains in English, precisely; in other languages the kind of the trouble stands before it. */
export function problemText(error: Error): string {
  if (!(error instanceof Problem)) return error.message;
  if (error.status === 0) return t("common.problem.no_answer");
  if (language() === "en") return error.message;
  return `${t(`common.problem.${kind(error.status)}`)} (${error.message})`;
}

function kind(status: number) {
  if (status === 401) return "signed_out";
  if (status === 403) return "not_allowed";
  if (status === 404) return "not_found";
  if (status === 409) return "conflict";
  if (status === 429) return "too_many";
  if (status === 503) return "overloaded";
  return status < 500 ? "invalid" : "service";
}
