import { useDocumentTitle } from "@mantine/hooks";
import { MOST, useUnread } from "../api/unread";
import { whole } from "../lib/format";

/** Name the page in the browser's tab, with the number of alerts that nobody has looked at here. */
export function useTitle(title: string): void {
  const { unread } = useUnread();
  useDocumentTitle(titled(title, unread.length));
}

export function titled(title: string, unread: number): string {
  const count = unread > MOST ? `${whole(MOST)}+` : whole(unread);
  return `${unread > 0 ? `(${count}) ` : ""}${title} · Livella`;
}
