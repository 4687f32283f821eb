#pragma once

namespace xrds {

/// While it lives, the console of Windows shows what is printed as UTF-8. Pipes and other systems do not notice.
class Utf8Console {
 public:
  Utf8Console();
  ~Utf8Console();
  Utf8Console(const Utf8Console&) = delete;
  Utf8Console& operator=(const Utf8Console&) = delete;

 private:
  unsigned previous_ = 0;  // code page; 0: there is no console
};

}  // namespace xrds
