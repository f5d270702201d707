#include "lodestone/emulation/arduino.h"

#include <array>
#include <cstdarg>
#include <cstddef>
#include <string>
#include <utility>

extern "C" {
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_irq.h>
}

#include "firmware_image.h"
#include "lodestone/common/error.h"

namespace lodestone::emulation {

namespace {

constexpr std::uint32_t kFrequency_Hz = 16000000;
constexpr avr_cycle_count_t kLongestRun = 400;  // cycles between two looks at the clock: 25 us
constexpr int kEmergencyPin = 0;                // PA0, pin 22 of an Arduino Mega
constexpr int kContactorPin = 1;                // PA1, pin 23
constexpr std::array<std::uint8_t, 2> kEndlessLoop = {0xff, 0xcf};  // rjmp to itself

void no_sleep(avr_t*, avr_cycle_count_t) {}
void quiet(avr_t*, const int, const char*, va_list) {}

}  // namespace

struct Arduino::State {
  Sink to_host;
  Sink to_controllers;
  avr_t* avr = nullptr;
  avr_irq_t* host_in = nullptr;
  avr_irq_t* controllers_in = nullptr;
  avr_irq_t* emergency_pin = nullptr;
  void (*core_reset)(avr_t*) = nullptr;
  int resets = -1;  // the first is the start
  bool fresh = false;
  bool emergency_open = false;
  bool hung = false;
  avr_flashaddr_t hung_at = 0;
  std::array<std::uint8_t, 2> overwritten{};

  ~State() {
    if (avr != nullptr) avr_terminate(avr);
  }
  static void on_reset(avr_t* avr) {
    State& state = *static_cast<State*>(avr->custom.data);
    if (state.core_reset != nullptr) state.core_reset(avr);
    ++state.resets;
    state.fresh = true;
  }
  /// After a reset the peripherals have forgotten what is connected to them.
  void reconnect() {
    fresh = false;
    if (hung)
      for (std::size_t i = 0; i < overwritten.size(); ++i) avr->flash[hung_at + i] = overwritten[i];
    hung = false;
    for (const char uart : {'0', '1'}) {
      std::uint32_t flags = 0;  // by default every poll of the status would sleep
      avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS(uart), &flags);
    }
    set_emergency_pin();
  }
  void set_emergency_pin() {
    // The switch is stronger than the pull-up.
    avr_ioport_external_t wire{};
    wire.name = 'A';
    wire.mask = 1u << kEmergencyPin;
    wire.value = emergency_open ? wire.mask : 0u;
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL('A'), &wire);
    avr_raise_irq(emergency_pin, emergency_open ? 0 : 1);
    avr_raise_irq(emergency_pin, emergency_open ? 1 : 0);
  }
};

Arduino::Arduino(Sink to_host, Sink to_controllers, std::size_t motor_controllers)
    : state_(std::make_unique<State>()) {
  LODESTONE_CHECK(motor_controllers >= 1 && motor_controllers <= kFirmware.size(),
                  "firmware for 1 to 8 motor controllers");
  const FirmwareImage& firmware = kFirmware[motor_controllers - 1];
  avr_global_logger_set(quiet);
  State& state = *state_;
  state.to_host = std::move(to_host);
  state.to_controllers = std::move(to_controllers);
  state.avr = avr_make_mcu_by_name("atmega2560");
  if (state.avr == nullptr) throw common::HardwareError("the emulator does not know the ATmega2560");
  avr_t* const avr = state.avr;
  avr_init(avr);
  avr->frequency = kFrequency_Hz;
  avr->sleep = no_sleep;
  avr->run_cycle_limit = kLongestRun;
  avr_loadcode(avr, const_cast<std::uint8_t*>(firmware.bytes), static_cast<std::uint32_t>(firmware.size), 0);
  avr->codeend = static_cast<std::uint32_t>(firmware.size);
  avr->custom.data = &state;
  state.core_reset = avr->reset;
  state.host_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  state.controllers_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_INPUT);
  state.emergency_pin = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('A'), kEmergencyPin);
  avr_irq_register_notify(
      avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* s) {
        static_cast<State*>(s)->to_host(static_cast<std::uint8_t>(value));
      },
      &state);
  avr_irq_register_notify(
      avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* s) {
        static_cast<State*>(s)->to_controllers(static_cast<std::uint8_t>(value));
      },
      &state);
  avr->reset = State::on_reset;
  avr_reset(avr);
}

Arduino::~Arduino() = default;

double Arduino::now_s() const { return static_cast<double>(state_->avr->cycle) / kFrequency_Hz; }

void Arduino::run_until(double time_s) {
  avr_t* const avr = state_->avr;
  const auto end = static_cast<avr_cycle_count_t>(time_s * kFrequency_Hz);
  while (avr->cycle < end) {
    if (state_->fresh) state_->reconnect();
    const int state = avr_run(avr);
    if (state == cpu_Done || state == cpu_Crashed)
      throw common::HardwareError("the emulated firmware has crashed at byte " + std::to_string(avr->pc) +
                                  " of its image");
  }
}

void Arduino::host_byte(std::uint8_t byte) { avr_raise_irq(state_->host_in, byte); }
void Arduino::controller_byte(std::uint8_t byte) { avr_raise_irq(state_->controllers_in, byte); }

void Arduino::set_emergency_stop(bool open) {
  state_->emergency_open = open;
  state_->set_emergency_pin();
}

bool Arduino::contactor() const {
  avr_ioport_state_t port{};
  avr_ioctl(state_->avr, AVR_IOCTL_IOPORT_GETSTATE('A'), &port);
  return (port.port & port.ddr & 1u << kContactorPin) != 0;
}

void Arduino::hang() {
  State& state = *state_;
  if (state.hung) return;
  state.hung = true;
  state.hung_at = state.avr->pc;
  for (std::size_t i = 0; i < kEndlessLoop.size(); ++i) {
    state.overwritten[i] = state.avr->flash[state.hung_at + i];
    state.avr->flash[state.hung_at + i] = kEndlessLoop[i];
  }
}

int Arduino::resets() const { return state_->resets; }

}  // namespace lodestone::emulation
