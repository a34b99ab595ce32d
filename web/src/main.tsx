import "./app/mantine.css";
import "virtual:theme.css";
import "./app/base.css";
import { createRoot } from "react-dom/client";
import { App } from "./app/App";
import { startText } from "./text";

const root = document.getElementById("root");
if (root) startText().then(() => createRoot(root).render(<App />));
