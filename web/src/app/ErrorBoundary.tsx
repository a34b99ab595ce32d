import { Component, type ReactNode } from "react";
import { Failed } from "../components/States";
import { t } from "../text";

/** A fault of the page itself: say so instead of showing nothing. */
export class ErrorBoundary extends Component<{ children: ReactNode }, { error: Error | null }> {
  override state: { error: Error | null } = { error: null };

  static getDerivedStateFromError(error: Error) {
    return { error };
  }

  override render() {
    const { error } = this.state;
    if (!error) return this.props.children;
    return <Failed what={t("shell.this_page")} error={error} retry={() => location.reload()} />;
  }
}
