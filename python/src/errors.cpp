#include <filesystem>

#include "bindings.h"
#include "lodestone/common/error.h"

namespace lodestone::python {
namespace {

void raise(const char* name, const std::exception& error) {
  const py::object kind = py::module_::import("lodestone.errors").attr(name);
  PyErr_SetString(kind.ptr(), error.what());
}

}  // namespace

void bind_errors() {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const common::ConfigError& error) {
      raise("ConfigError", error);
    } catch (const common::CheckpointError& error) {
      raise("CheckpointError", error);
    } catch (const common::DataError& error) {
      raise("DataError", error);
    } catch (const common::IoError& error) {
      raise("IoError", error);
    } catch (const common::HardwareError& error) {
      raise("HardwareError", error);
    } catch (const std::filesystem::filesystem_error& error) {
      raise("IoError", error);
    } catch (const common::Interrupted&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    } catch (const common::Error& error) {
      raise("Error", error);
    }
  });
}

}  // namespace lodestone::python
