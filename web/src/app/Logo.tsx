/** A spirit level: that is what "livella" means. */
export function Logo({ size = 28 }: { size?: number }) {
  return (
    <svg width={size * 1.4} height={size} viewBox="0 0 42 30" aria-hidden="true">
      <rect x="1" y="7" width="40" height="16" rx="8" fill="#0b6e93" />
      <path d="M14 7v16M28 7v16" stroke="#fff" strokeWidth="2" opacity="0.65" />
      <ellipse cx="21" cy="14.5" rx="5.2" ry="4.4" fill="#fff" />
    </svg>
  );
}
