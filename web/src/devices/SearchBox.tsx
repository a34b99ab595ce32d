import { TextInput } from "@mantine/core";
import { useDebouncedCallback } from "@mantine/hooks";
import { Search } from "lucide-react";
import { useState } from "react";
import { t } from "../text";

/** ms without a key being pressed */
const PAUSE = 250;

interface SearchBoxProps {
  value: string;
  onChange: (value: string) => void;
}

/** What is typed is passed on at the next pause; until then it is kept here. */
export function SearchBox({ value, onChange }: SearchBoxProps) {
  const [typed, setTyped] = useState<string | null>(null);
  const passOn = useDebouncedCallback((text: string) => {
    onChange(text);
    setTyped(null);
  }, PAUSE);
  return (
    <TextInput
      type="search"
      aria-label={t("devices.search")}
      placeholder={t("devices.search_example")}
      leftSection={<Search size={18} aria-hidden />}
      value={typed ?? value}
      onChange={({ currentTarget }) => {
        setTyped(currentTarget.value);
        passOn(currentTarget.value);
      }}
    />
  );
}
