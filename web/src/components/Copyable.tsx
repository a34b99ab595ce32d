import { ActionIcon } from "@mantine/core";
import { Check, Copy } from "lucide-react";
import { useRef, useState } from "react";
import { t } from "../text";
import css from "./copyable.module.css";

/** Text to be carried elsewhere, with a copy button. */
export function Copyable({ label, text }: { label: string; text: string }) {
  const [copied, setCopied] = useState(false);
  const source = useRef<HTMLElement>(null);
  const copy = async () => {
    setCopied(await copyText(text, source.current));
    setTimeout(() => setCopied(false), 2500);
  };
  return (
    <div>
      <div className={css.label}>{label}</div>
      <div className={css.box}>
        <code ref={source}>{text}</code>
        <ActionIcon onClick={copy} aria-label={t("common.copy", { label })}>
          {copied ? <Check size={20} aria-hidden /> : <Copy size={20} aria-hidden />}
        </ActionIcon>
      </div>
      <span className="visually-hidden" role="status">
        {copied && t("common.copied")}
      </span>
    </div>
  );
}

/** Copy; on plain http in a workshop's network there is no clipboard interface, so select the text and use the old command. */
async function copyText(text: string, source: HTMLElement | null): Promise<boolean> {
  if (navigator.clipboard) {
    return navigator.clipboard.writeText(text).then(
      () => true,
      () => false,
    );
  }
  if (!source) return false;
  getSelection()?.selectAllChildren(source);
  return document.execCommand("copy");
}
